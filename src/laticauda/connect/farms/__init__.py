"""Animats of FARMS (github.com/farmsim): their morphology as a robot, their oscillators as a network.

- `loading`: which files an animat consists of; `assembly`: how it is put together
- `animat`, `remarks`: what is read of it, and what is not
- `entries`: tables in YAML files; `sdf`, `mjcf`, `mesh_points`: bodies in their files
- `bodies`, `trees`: rigid bodies and hinges; `spine`: the chain from head to tail among them
- `robots`, `drag`: modules and joints of a robot, and their drag
- `network_file`, `bonds`, `oscillators`: the network; `motors`: the joint law
"""

from laticauda.connect.farms.animat import FarmsAnimat as FarmsAnimat
from laticauda.connect.farms.loading import load_farms as load_farms

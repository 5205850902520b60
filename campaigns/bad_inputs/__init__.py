"""The parts of `campaigns/bad_input.py`.

- `attempt`: one bad input is tried in a process of its own, and what came of it is judged;
- `surface`: what there is to attack: options, fields of messages, public calls, taken from the package
  itself, and the few that are left out, with reasons;
- `odd`: words and values that nothing should accept, or only some things;
- `pantry`: good files, for commands that need one beside the bad input;
- `command_kinds`, `call_kinds`, `message_kinds`, `file_kinds`, `damage_kinds`, `environment_kinds`,
  `plausible_kinds`: endless series of bad inputs of each kind.
"""

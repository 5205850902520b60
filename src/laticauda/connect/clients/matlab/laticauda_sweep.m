function [amplitude, frequency, velocity, power] = laticauda_sweep (client)
  % A sweep from the other side: 20 gaits, 4 amplitudes times 5 frequencies, 30 s each, in the paper's water.
  %
  %   client = laticauda_client ();
  %   laticauda_sweep (client);
  %
  % Returns column vectors [rad, rad/s, m/s, W]; without outputs it prints a table.
  [frequency, amplitude] = meshgrid ((60:30:180) * pi / 180, (15:10:45) * pi / 180);
  amplitude = amplitude(:);
  frequency = frequency(:);
  velocity = zeros (size (amplitude));
  power = zeros (size (amplitude));
  for i = 1:numel (amplitude)
    gait = struct ('amplitude', amplitude(i), 'frequency', frequency(i), 'phase_shift', 40 * pi / 180);
    reply = client.run (30, struct ('robot', 'mamba', 'gait', gait));
    velocity(i) = reply.figures.forward_velocity;
    power(i) = reply.figures.mean_power;
  end
  if nargout == 0
    printed = [amplitude, frequency, velocity, power]';
    fprintf ('amplitude %.4f rad  frequency %.4f rad/s  velocity %.6f m/s  power %.6f W\n', printed);
  end
end

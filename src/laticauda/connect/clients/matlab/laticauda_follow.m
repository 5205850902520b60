function [time, position, heading] = laticauda_follow (client, duration, start)
  % Path following from the other side: line-of-sight guidance, written here, along the x axis.
  %
  %   client = laticauda_client ();
  %   [time, position] = laticauda_follow (client, 60, [0, 0.5]);
  %
  % START is where the center of mass begins, x y [m]; it heads along x. Every 0.05 s the heading reference is
  % -atan (y / Delta), and the joints' offset k times the heading error, cut off at 20 deg.
  look_ahead = 0.18;             % Delta [m]
  gain = 0.4;                    % k [-]
  most = 20 * pi / 180;          % [rad]
  interval = 0.05;               % [s]
  gait = struct ('amplitude', 30 * pi / 180, 'frequency', 90 * pi / 180, 'phase_shift', 40 * pi / 180);
  reply = client.reset (struct ('robot', 'mamba-fin', 'gait', gait, 'center_of_mass', start));
  n = round (duration / interval);
  time = zeros (n + 1, 1);
  position = zeros (n + 1, 2);
  heading = zeros (n + 1, 1);
  for i = 1:n+1
    seen = reply.observation;
    time(i) = seen.time;
    position(i, :) = seen.center_of_mass(:)';
    heading(i) = seen.heading;
    if i <= n
      reference = -atan2 (seen.center_of_mass(2), look_ahead);
      difference = reference - seen.heading;
      difference = atan2 (sin (difference), cos (difference));
      offset = min (max (gain * difference, -most), most);
      reply = client.step (interval, struct ('offset', offset));
    end
  end
end

classdef laticauda_client < handle
  % A robot in water that `laticauda serve` swims, driven from GNU Octave or MATLAB.
  %
  %   client = laticauda_client ();                     % or (host, port, timeout, token)
  %   reply = client.reset (struct ('robot', 'mamba-fin'));
  %   reply = client.step (0.05, struct ('offset', 0.1));
  %   reply.observation.heading
  %   reply = client.run (30, struct ('gait', struct ('amplitude', 0.5)));
  %   reply.figures.forward_velocity
  %   client.close ();
  %
  % Fields and units: docs/cosim-protocol.md. What the server refuses becomes an error with its sentence. Octave needs
  % the package instrument-control (on Debian and Ubuntu: octave-instrument-control); MATLAB has tcpclient itself.

  properties (SetAccess = private)
    wire      % the tcpclient
    token     % what the server has printed, if it is on another computer
    rest      % bytes that came in after the last end of line
  end

  methods
    function self = laticauda_client (host, port, timeout, token)
      % Connect; TIMEOUT, in seconds, is how long an answer may take. TOKEN: left out, the variable LATICAUDA_TOKEN.
      if nargin < 1, host = '127.0.0.1'; end
      if nargin < 2, port = 5055; end
      if nargin < 3, timeout = 60; end
      if nargin < 4, token = getenv ('LATICAUDA_TOKEN'); end
      if exist ('OCTAVE_VERSION', 'builtin')
        pkg ('load', 'instrument-control');
      end
      self.wire = tcpclient (host, port, 'Timeout', timeout);
      self.rest = uint8 ([]);
      self.token = token;
    end

    function reply = reset (self, fields)
      % A new world at time 0.
      if nargin < 2, fields = struct (); end
      reply = self.ask ('reset', fields);
    end

    function reply = step (self, duration, fields)
      % Let DURATION seconds go by, under what FIELDS change.
      if nargin < 3, fields = struct (); end
      fields.duration = duration;
      reply = self.ask ('step', fields);
    end

    function reply = change (self, fields)
      % The request `set`: another command or current, while time stands still.
      reply = self.ask ('set', fields);
    end

    function reply = look (self, fields)
      % The request `get`: where the robot is, or time series of the log.
      if nargin < 2, fields = struct (); end
      reply = self.ask ('get', fields);
    end

    function reply = run (self, duration, fields)
      % A swim of DURATION seconds from start to end in a world of its own, and its figures.
      if nargin < 3, fields = struct (); end
      fields.duration = duration;
      reply = self.ask ('run', fields);
    end

    function reply = ask (self, request, fields)
      % Any request; the answer as a struct.
      fields.('do') = request;
      if ~ isempty (self.token), fields.token = self.token; end
      write (self.wire, uint8 ([jsonencode(fields), char(10)]));
      reply = jsondecode (self.line ());
      if isfield (reply, 'error')
        error ('laticauda:refused', '%s', reply.error);
      end
    end

    function close (self)
      % Leave; the server forgets the world.
      self.wire = [];
    end
  end

  methods (Access = private)
    function text = line (self)
      % The next line, without its end.
      pieces = {self.rest};
      while ~ any (pieces{end} == 10)
        % One byte is waited for, and what has come with it is taken along.
        piece = uint8 (read (self.wire, max (1, self.wire.NumBytesAvailable)));
        if isempty (piece)
          error ('laticauda:silent', 'The server did not answer in time, or has gone.');
        end
        pieces{end+1} = piece(:)';
      end
      bytes = [pieces{:}];
      last = find (bytes == 10, 1);
      text = char (bytes(1:last-1));
      self.rest = bytes(last+1:end);
    end
  end
end

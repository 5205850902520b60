# A robot in water that `laticauda serve` swims, driven from Julia, with its package JSON (`import Pkg; Pkg.add("JSON")`).
#
#     include("LaticaudaClient.jl")
#     robot = LaticaudaClient.open("127.0.0.1", 5055)
#     LaticaudaClient.ask(robot, "reset"; robot = "mamba", joints = "servo")
#     answer = LaticaudaClient.ask(robot, "step"; duration = 0.05, offset = 0.1)
#     answer["observation"]["heading"]
#     LaticaudaClient.close(robot)
#
# Messages and units: docs/cosim-protocol.md. Nobody has run this file yet.

module LaticaudaClient

import JSON
import Sockets

struct Client
    wire::Sockets.TCPSocket
    token::String
end

"Connect; `token` is what the server has printed, if it did."
open(host = "127.0.0.1", port = 5055; token = get(ENV, "LATICAUDA_TOKEN", "")) =
    Client(Sockets.connect(host, port), token)

"Send a request with its fields, and return the answer as a dictionary; a refusal is an error with its sentence."
function ask(client::Client, request::AbstractString; fields...)
    message = Dict{String,Any}(String(name) => value for (name, value) in fields)
    message["do"] = request
    isempty(client.token) || (message["token"] = client.token)
    println(client.wire, JSON.json(message))
    line = readline(client.wire)
    isempty(line) && error("The server has gone.")
    answer = JSON.parse(line)
    haskey(answer, "error") && error(answer["error"])
    return answer
end

"Leave; the server forgets the world."
close(client::Client) = Base.close(client.wire)

end

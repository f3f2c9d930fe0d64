// What a row of the benchmark implements: four roles over one way of moving bytes. Each role lives in a process of its
// own.
#pragma once

#include "frame.hpp"
#include "run.hpp"

#include <functional>
#include <memory>
#include <span>

namespace hive::bench {

class Script;

/// Looks at a frame that came; false: it was the last.
using OnFrame = std::function<bool(std::span<const std::byte>)>;
/// The answer to a request; false: it was the last request.
using OnRequest = std::function<bool(const Request&, Frame& answer)>;

class Publisher {
public:
    virtual ~Publisher() = default;
    /// Sends what the script says, when it says so, and returns at its end. Throws when that is impossible.
    virtual void publish(Script& script) = 0;
};

/// A publisher whose transport takes one frame after another. Waits when the receivers are too slow.
class PushPublisher : public Publisher {
public:
    void publish(Script& script) final;

protected:
    virtual void send(const Frame& frame) = 0;
};

class Subscriber {
public:
    virtual ~Subscriber() = default;
    /// Hands over each frame, and returns after the last.
    virtual void receive(const OnFrame& on_frame) = 0;
};

class Server {
public:
    virtual ~Server() = default;
    /// Answers each request, and returns after the last. `serving` is to be called when requests can come.
    virtual void serve(const std::function<void()>& serving, const OnRequest& on_request) = 0;
};

class Client {
public:
    virtual ~Client() = default;
    /// One round trip. True when the answer was right; it is touched by FrameCheck::whole when it is a frame.
    virtual bool ask(const Request& request, const FrameCheck& check) = 0;
};

class Transport {
public:
    virtual ~Transport() = default;
    virtual std::unique_ptr<Publisher> publisher(const Run& run) const = 0;
    virtual std::unique_ptr<Subscriber> subscriber(const Run& run) const = 0;
    virtual std::unique_ptr<Server> server(const Run& run) const = 0;
    virtual std::unique_ptr<Client> client(const Run& run) const = 0;

    /// Does the test need a server and a client, or a publisher and subscribers?
    [[nodiscard]] virtual bool answers(const Run& run) const { return run.test == Test::rpc || run.test == Test::sync; }
    /// Frames under way at once when the transport itself would lose or pile up; 0: it holds the publisher back.
    [[nodiscard]] virtual int credit(const Run&) const { return 0; }
    /// Controller: before the roles are started, when they are, and when they have ended.
    virtual void prepare(Run&) const {}
    virtual void wire(const Run&) const {}
    virtual void clean(const Run&) const {}
};

/// The main function of a row's program: one run, one line of JSON on stdout. Returns the exit code: 0 when nothing was
/// lost and nothing corrupt.
int row_main(const std::string& program, const Transport& transport, int argc, char** argv);

}  // namespace hive::bench

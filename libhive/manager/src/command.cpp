// Runs a child with two pipes and a deadline.
#include "running_command.hpp"

#include "child.hpp"

#include <hive/error.hpp>
#include <hive/transport/descriptor.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>
#include <utility>

namespace hive {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t most_output = 16 << 20;
constexpr std::chrono::seconds grace(1);  ///< between SIGTERM and SIGKILL

}  // namespace

struct RunningCommand::Parts {
    /// One stream of a child, read here.
    class Pipe {
    public:
        Pipe()
        {
            std::array<int, 2> ends{};
            require_done(::pipe2(ends.data(), O_CLOEXEC) == 0 ? 0 : errno, "make a pipe");
            ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
            exit_ = transport::Descriptor(ends[0]);
            entry_ = transport::Descriptor(ends[1]);
        }

        [[nodiscard]] int exit() const { return exit_.get(); }
        [[nodiscard]] int entry() const { return entry_.get(); }
        void close_entry() { transport::Descriptor(std::move(entry_)); }
        /// Reads the available bytes; false at the end of the stream.
        bool read(std::string& text) const
        {
            std::array<char, 16 * 1024> buffer;
            const auto size = ::read(exit(), buffer.data(), buffer.size());
            if (size > 0)
                text.append(buffer.data(), static_cast<std::size_t>(size));
            if (text.size() > most_output)
                throw Error(Errc::too_large, "a command printed more than 16 MiB");
            return size > 0 || (size < 0 && (errno == EINTR || errno == EAGAIN));
        }

    private:
        transport::Descriptor exit_, entry_;
    };

    Parts(const std::vector<std::string>& words, std::chrono::milliseconds limit,
          const std::vector<std::string>& environment)
        : end(Clock::now() + limit),
          child({.words = words, .environment = environment, .out = out.entry(), .err = err.entry()})
    {
        out.close_entry();
        err.close_entry();
        streams = {{{out.exit(), POLLIN, 0}, {err.exit(), POLLIN, 0}, {child.descriptor(), POLLIN, 0}}};
    }
    ~Parts() { stop(); }
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;
    int stop()
    {
        child.end(Clock::now() + grace);
        return exit_code_of_status(*child.ended());
    }
    /// Reads the available bytes.
    void read()
    {
        if (streams[0].revents != 0 && !out.read(result.out))
            streams[0].fd = -1;
        if (streams[1].revents != 0 && !err.read(result.err))
            streams[1].fd = -1;
        if (streams[2].revents != 0)
            streams[2].fd = -1;
    }
    /// Does not wait for the end of stderr: the connection that ssh leaves open may hold it.
    [[nodiscard]] bool ended() const { return streams[0].fd < 0 && streams[2].fd < 0; }
    void read_rest_of_errors()
    {
        for (auto before = std::string::npos; before != result.err.size();) {
            before = result.err.size();
            err.read(result.err);
        }
    }

    Clock::time_point end;
    Pipe out, err;
    Child child;
    std::array<pollfd, 3> streams{};
    CommandResult result;
};

RunningCommand::RunningCommand(const std::vector<std::string>& words, std::chrono::milliseconds limit,
                               const std::vector<std::string>& environment)
    : parts_(std::make_unique<Parts>(words, limit, environment))
{
}

RunningCommand::~RunningCommand() = default;

std::optional<CommandResult> RunningCommand::poll(std::chrono::milliseconds timeout)
{
    auto& parts = *parts_;
    for (const auto until = std::min(Clock::now() + timeout, parts.end);;) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
        const auto ready = ::poll(parts.streams.data(), parts.streams.size(),
                                  static_cast<int>(std::clamp<std::int64_t>(left, 0, 60'000)));
        if (ready > 0)
            parts.read();
        if (parts.ended()) {
            parts.read_rest_of_errors();
            parts.result.exit_code = parts.stop();
            return std::move(parts.result);
        }
        if (Clock::now() >= parts.end) {
            parts.result.late = true;
            parts.result.exit_code = parts.stop();
            return std::move(parts.result);
        }
        if (ready <= 0 && left <= 0)
            return std::nullopt;
    }
}

void RunningCommand::end() { parts_->end = Clock::now(); }

std::vector<int> RunningCommand::descriptors() const
{
    std::vector<int> open;
    for (const auto& stream : parts_->streams)
        if (stream.fd >= 0)
            open.push_back(stream.fd);
    return open;
}

CommandResult run_command(const std::vector<std::string>& words, std::chrono::milliseconds limit,
                          const std::vector<std::string>& environment, const std::function<bool()>& cancelled)
{
    constexpr std::chrono::milliseconds look_period(50);
    RunningCommand command(words, limit, environment);
    for (;;) {
        if (auto result = command.poll(cancelled ? look_period : limit))
            return *std::move(result);
        if (cancelled && cancelled())
            command.end();
    }
}

int run_attached(const std::vector<std::string>& words)
{
    Child child({.words = words, .environment = {}, .in = 0, .own_session = false});
    child.await_end(Clock::time_point::max());
    return exit_code_of_status(*child.ended());
}

}  // namespace hive

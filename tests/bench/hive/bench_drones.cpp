// Hive's own code from end to end: what is measured here is what a drone's author gets.
#include "bench_drones.hpp"

#include "../harness/script.hpp"

#include <hive/drone.hpp>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <exception>
#include <map>
#include <stdexcept>
#include <unistd.h>

namespace hive::bench {
namespace {

using std::chrono::microseconds;

constexpr auto frame_type = "application/octet-stream";
constexpr microseconds until_something_happens = std::chrono::milliseconds(20);

/// A drone ends as it does for a user: by SIGTERM.
void end_this_drone() { ::kill(::getpid(), SIGTERM); }

void run_as_drone(const Run& run, const std::string& name, const std::function<void(Drone&)>& body)
{
    std::vector<std::string> words{"bench_hive", "--name", name, "--log-level", "warning"};
    if (over_tcp(run) && name == source_name)
        words.insert(words.end(), {"--listen", tcp_address(run)});
    if (run.is("tcp"))
        words.emplace_back("--insecure");
    std::vector<char*> pointers;
    for (auto& word : words)
        pointers.push_back(word.data());
    if (run_drone(static_cast<int>(pointers.size()), pointers.data(), {"bench", "Part of a benchmark."}, body) != 0)
        throw std::runtime_error(name + " failed");
}

/// Fills loans as a camera would that writes its images in place: only header and tail are written, into memory that
/// holds an image already. A loan that is met for the first time is given one.
class InPlace {
public:
    void fill(Loan& loan, Frame frame)
    {
        auto* memory = reinterpret_cast<std::byte*>(loan.data());
        const auto [place, fresh] = drawn_.try_emplace(memory, Drawn{frame.header.camera, frame.image});
        const auto& [camera, image] = place->second;
        if (fresh || !still_there(image, memory))
            std::memcpy(memory, image.data(), image.size());
        frame.header.camera = camera;
        frame.stamp(memory);
    }

private:
    struct Drawn {
        std::uint32_t camera;
        std::span<const std::byte> image;
    };

    /// Memory that was given back to the system has lost its image; a few places show it.
    static bool still_there(std::span<const std::byte> image, const std::byte* memory)
    {
        constexpr std::size_t places = 16;
        const auto step = std::max<std::size_t>(1, image.size() / places);
        for (std::size_t i = sizeof(FrameHeader); i + sizeof(FrameTail) < image.size(); i += step)
            if (memory[i] != image[i])
                return false;
        return true;
    }

    std::map<const std::byte*, Drawn> drawn_;
};

class Source : public Publisher {
public:
    explicit Source(const Run& run) : run_(run), on_demand_(run.test != Test::latency) {}

    void publish(Script& script) override
    {
        run_as_drone(run_, source_name, [&](Drone& drone) {
            const Output output = drone.output(frame_port, frame_type);
            drone.main([&, output] { return guarded_step(script, output); });
            drone.run();
        });
        if (failure_)
            std::rethrow_exception(failure_);
    }

private:
    microseconds guarded_step(Script& script, const Output& output)
    {
        try {
            return step(script, output);
        } catch (...) {
            failure_ = std::current_exception();
            end_this_drone();
            return std::chrono::hours(1);
        }
    }

    microseconds step(Script& script, const Output& output)
    {
        const auto due = script.due();
        if (!due) {
            end_this_drone();
            return std::chrono::hours(1);
        }
        if (const auto early = *due - now_ns(); early > 0)
            return microseconds(early / 1000 + 1);
        if (on_demand_ && !output.asked())
            return until_something_happens;  // called at once when it is asked
        emit(script.next(), output);
        return microseconds(0);
    }

    void emit(const Frame& frame, const Output& output)
    {
        if (on_demand_)
            output.emit_captured(std::chrono::system_clock::now(), true, Json::object(),
                                 [&] { return body_of(frame, output); });
        else
            output.emit(Json::object(), body_of(frame, output));
    }

    Body body_of(const Frame& frame, const Output& output)
    {
        Loan loan = output.loan(frame.image.size());
        if (run_.is("zc"))
            in_place_.fill(loan, frame);
        else
            frame.produce(reinterpret_cast<std::byte*>(loan.data()));
        return loan;
    }

    Run run_;
    bool on_demand_;  ///< lossless events, each when every receiver has asked
    InPlace in_place_;
    std::exception_ptr failure_;
};

class Sink : public Subscriber {
public:
    explicit Sink(const Run& run) : run_(run) {}

    void receive(const OnFrame& on_frame) override
    {
        run_as_drone(run_, sink_name(run_.index), [&](Drone& drone) {
            drone.on_event(frame_port, frame_type, [&](const Event& event) {
                if (!on_frame(event.body.bytes()))
                    end_this_drone();
            });
            drone.run();
        });
    }

private:
    Run run_;
};

class AnsweringDrone : public Server {
public:
    explicit AnsweringDrone(const Run& run) : run_(run) {}

    void serve(const std::function<void()>& serving, const OnRequest&) override
    {
        run_as_drone(run_, source_name, [&](Drone& drone) {
            std::string note = note_text;
            drone.parameter(note_parameter, note, anything(), "what is asked for");
            drone.main([&] {
                serving();
                return std::chrono::hours(1);
            });
            drone.run();
        });
    }

private:
    Run run_;
};

}  // namespace

std::string sink_name(int index) { return "sink-" + std::to_string(index); }
bool over_tcp(const Run& run) { return run.is("tcp") || run.is("tls"); }

std::string tcp_address(const Run& run) { return "tcp://127.0.0.1:" + std::to_string(run.port); }

std::unique_ptr<Publisher> make_source(const Run& run) { return std::make_unique<Source>(run); }
std::unique_ptr<Subscriber> make_sink(const Run& run) { return std::make_unique<Sink>(run); }
std::unique_ptr<Server> make_answering_drone(const Run& run) { return std::make_unique<AnsweringDrone>(run); }

}  // namespace hive::bench

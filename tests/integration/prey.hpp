// The drones that the hostile peers are let loose on, and the witness that nothing happened to them.
#pragma once

#include <raw_peer.hpp>

#include <swarm.hpp>

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace hostile {

using hive::test::Clock;
using hive::test::Milliseconds;
using raw::Json;

/// A deadline that only guards against hanging: three times as long, for a slow machine. What is stated is measured
/// without it.
inline Milliseconds within(int milliseconds) { return Milliseconds(3 * milliseconds); }

/// A drone in a home of its own.
class Prey {
public:
    explicit Prey(const std::string& kind, const std::vector<std::string>& settings = {});
    /// A small camera, 30 frames per second.
    static Prey camera() { return Prey("camera", {"width=320", "height=240", "fps=30", "noise=0"}); }
    static Prey face() { return Prey("face"); }

    [[nodiscard]] std::filesystem::path socket() const { return swarm_->home() / "prey.sock"; }
    [[nodiscard]] raw::Peer dial() const { return raw::Peer::dial(socket()); }
    [[nodiscard]] raw::Peer meet(const std::string& name = "raw") const { return raw::Peer::meet(socket(), name); }
    [[nodiscard]] const hive::test::Swarm& swarm() const { return *swarm_; }
    [[nodiscard]] pid_t pid() const { return process_.pid(); }
    [[nodiscard]] std::string log() const { return swarm_->log("prey"); }
    /// Is it the same process, and does it answer, once in three times, before its peers would declare it dead, which
    /// they do after two seconds?
    [[nodiscard]] bool well() const;

private:
    std::unique_ptr<hive::test::Swarm> swarm_ = std::make_unique<hive::test::Swarm>();
    hive::test::Process process_;
};

/// A peer that behaves: receives `image` as a stream in a thread of its own, and finds the gaps in the sequence. What
/// is missing after it was itself held up does not count: live frames are not kept for a receiver that is late.
class Witness {
public:
    explicit Witness(const Prey& prey);
    ~Witness();
    Witness(const Witness&) = delete;
    Witness& operator=(const Witness&) = delete;
    [[nodiscard]] int received() const { return received_; }
    [[nodiscard]] int lost() const { return lost_; }
    [[nodiscard]] bool cut_off() const { return cut_off_; }

private:
    void receive();
    raw::Peer peer_;
    std::atomic<int> received_ = 0, lost_ = 0;
    std::atomic<bool> cut_off_ = false, stop_ = false;
    std::thread thread_;
};

/// How long some answers to `status` take, one each 20 ms; the longest time there is for one that is an error.
std::vector<Milliseconds> answer_times(raw::Peer& peer, int times);

/// Where nothing disturbs the measurement: nine in ten answers come within 100 ms, and none is an error.
void check_answers(std::vector<Milliseconds> times);

}  // namespace hostile

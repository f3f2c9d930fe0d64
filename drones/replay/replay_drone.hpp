// Declares the outputs of a recording, and sends its events on them unchanged.
#pragma once

#include "playback.hpp"

#include <hive/drone.hpp>

#include <memory>
#include <string>
#include <vector>

namespace replay {

/// User thread.
class ReplayDrone {
public:
    /// The outputs are those of the recording with which the drone is started; without one there is `events`, for
    /// everything.
    explicit ReplayDrone(hive::Drone& drone);
    void run() { drone_.run(); }

private:
    struct Declared {
        hive::recording::Port port;
        hive::Output output;
    };
    struct Opened {  ///< a difference means reopening
        std::string file;
        Range range;
        bool operator==(const Opened&) const = default;
    };

    enum class Step { when_due, when_asked, none };

    void declare();
    void declare_outputs();
    void apply();
    void open(const Opened& wanted);
    [[nodiscard]] Range range() const;
    [[nodiscard]] std::vector<std::size_t> outputs_for(const std::vector<hive::recording::Track>& tracks) const;
    [[nodiscard]] bool has_receivers() const;
    [[nodiscard]] bool overtakes() const;
    Step next_step();
    std::chrono::microseconds step();
    bool prepare();
    void take_next();
    void send();
    [[nodiscard]] const hive::Output& output() const
    {
        return outputs_[output_of_[playback_->current()->prefix.track]].output;
    }
    void damaged(const std::string& what);
    std::chrono::microseconds at_end();

    hive::Drone& drone_;
    std::string file_, pace_ = "real";
    double speed_ = 1, from_ = 0, to_ = 0;
    bool loop_ = false;
    std::vector<Declared> outputs_;
    Opened opened_;
    std::unique_ptr<Playback> playback_;
    std::int64_t rounds_before_ = 0;      ///< started before this playback
    std::vector<std::size_t> output_of_;  ///< by track
    Timeline timeline_;
    bool started_ = false, ended_ = false, asked_before_ = false;
    std::optional<hive::Event> event_;  ///< the current one, without its body
    std::int64_t damaged_ = 0, without_body_ = 0;
};

}  // namespace replay

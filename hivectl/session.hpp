// What every verb shares: the common flags and the one application, made when it is first needed.
#pragma once

#include "status_line.hpp"
#include "terminal.hpp"

#include <hive/application.hpp>

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>

namespace hivectl {

class Session {
public:
    bool json = false;                ///< --json
    bool wide = false;                ///< --wide
    std::optional<double> timeout_s;  ///< --timeout

    [[nodiscard]] Form form() const { return json ? Form::json : wide ? Form::wide : Form::fitted; }
    /// What --timeout said, or the verb's own default.
    [[nodiscard]] std::chrono::milliseconds timeout(std::chrono::milliseconds fallback = std::chrono::seconds(5)) const;
    /// What --timeout said; nothing: wait for ever.
    [[nodiscard]] std::optional<std::chrono::milliseconds> patience() const
    {
        return timeout_s ? std::optional(timeout()) : std::nullopt;
    }
    /// Joins the swarm at the first call; --help and usage errors never come this far.
    hive::Application& application(std::chrono::milliseconds fallback = std::chrono::seconds(5));
    /// Where the drones of this machine meet; always absolute.
    [[nodiscard]] std::filesystem::path home() const;

private:
    std::optional<Waiting> waiting_;  ///< until the verb has something to say
    std::unique_ptr<hive::Application> application_;
};

}  // namespace hivectl

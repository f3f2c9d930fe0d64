// The shared part of all verbs: the common flags, and one application, created on first use.
#pragma once

#include "words/status_line.hpp"
#include "words/terminal.hpp"

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
    /// The value of --timeout, or the verb's own default.
    [[nodiscard]] std::chrono::milliseconds timeout(std::chrono::milliseconds fallback = std::chrono::seconds(5)) const;
    /// The value of --timeout; nothing: no limit.
    [[nodiscard]] std::optional<std::chrono::milliseconds> given_timeout() const
    {
        return timeout_s ? std::optional(timeout()) : std::nullopt;
    }
    /// Created at the first call; --help and usage errors never get here.
    hive::Application& application(std::chrono::milliseconds fallback = std::chrono::seconds(5));
    /// The home, as an absolute path.
    [[nodiscard]] std::filesystem::path home() const;

private:
    std::optional<Waiting> waiting_;  ///< until the verb prints
    std::unique_ptr<hive::Application> application_;
};

}  // namespace hivectl

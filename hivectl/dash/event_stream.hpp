// Writes server-sent events: each reader gets the newest snapshot when it is ready.
#pragma once

#include "snapshot.hpp"

#include <hive/http/answer.hpp>

#include <functional>
#include <memory>
#include <span>
#include <string>

namespace hivectl::dash {

/// For one reader, and one thread.
class EventStream final : public hive::http::EndlessBody {
public:
    static constexpr const char* type = "text/event-stream";
    using Newest = std::function<std::shared_ptr<const Snapshot>(hive::http::Clock::time_point now)>;

    /// @param repeat  after this long without a new snapshot a comment is sent, to detect closed readers
    EventStream(Newest newest, std::chrono::milliseconds repeat) : newest_(std::move(newest)), repeat_(repeat) {}
    std::size_t read(std::span<char> to, hive::http::Clock::time_point now) override;

private:
    void begin(hive::http::Clock::time_point now);

    Newest newest_;
    std::chrono::milliseconds repeat_;
    std::string text_;  ///< being sent
    std::size_t sent_ = 0;
    std::uint64_t version_ = 0;
    hive::http::Clock::time_point begun_{};
};

}  // namespace hivectl::dash

// Answers the page of hivectl dash. Never waits for a drone: slow work runs on other threads.
#pragma once

#include "errands.hpp"
#include "images.hpp"
#include "watch.hpp"

#include <hive/http/server.hpp>

#include <string>
#include <vector>

namespace hivectl::dash {

class Site final : public hive::http::Site {
public:
    struct Settings {
        std::filesystem::path home{};
        std::chrono::milliseconds timeout{};  ///< of requests to drones
        std::size_t streams = 0;              ///< maximum number of pages at once
        std::chrono::milliseconds repeat{};   ///< interval of a stream without news
    };
    static constexpr std::size_t max_body = 64 * 1024;

    explicit Site(Settings settings);

private:
    using Answer = std::optional<hive::http::Answer>;
    using Request = hive::http::Request;
    using Visit = hive::http::Visit;
    using Words = std::vector<std::string>;

    Answer answer(const Request& request, Visit& visit) override;
    std::size_t takes(const Request& request, const Visit& visit) override;
    [[nodiscard]] static Answer refusal(const Request& request, const Visit& visit);
    Answer answer_get(const Words& path, const Request& request, Visit& visit);
    Answer events(const Visit& visit);
    [[nodiscard]] Answer drawing() const;
    Answer image(const Words& path, Visit& visit);
    /// Requests to drones: started at the first call, and answered when done.
    using ToAnswer = hive::http::Answer (*)(const hive::Json& result);
    template <typename MakeWork>
    static Answer errand(Errands& errands, Visit& visit, MakeWork make_work, ToAnswer to_answer);

    const Settings settings_;
    Watch watch_;
    Errands orders_, questions_;  ///< separate, so that a command never waits for a query
    Images images_;
};

}  // namespace hivectl::dash

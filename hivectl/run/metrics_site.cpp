// Checks the client, then queries the drones.
#include "run/metrics_site.hpp"

namespace hivectl {

using hive::http::Answer, hive::http::sentence;

/// Without a token, a server at a loopback address checks the host against DNS rebinding. Elsewhere (--insecure) any
/// name is valid, such as that of a container.
std::optional<Answer> MetricsSite::refusal(const hive::http::Request& request, const hive::http::Visit& visit) const
{
    if (hive::http::Pass::cross_site(request))
        return sentence(403, "Other pages may not read this.");
    if (!open_ && !visit.pass.in_header(request))
        return sentence(401, "Send the token of --token-file as Authorization: Bearer TOKEN.");
    if (open_ && visit.bind.loopback() && (!request.host || !host_fits(*request.host, visit.bind)))
        return sentence(request.host ? 403 : 400, "Open this by its address.");
    if (request.method != "GET")
        return sentence(405, "Only GET.");
    return std::nullopt;
}

/// Caches for 100 ms, so that frequent requests do not load the drones.
const hive::Metrics& MetricsSite::newest(hive::http::Clock::time_point now)
{
    constexpr std::chrono::milliseconds fresh{100};
    if (newest_.empty() || now - asked_ > fresh) {
        newest_ = hive::metrics(application_);
        asked_ = hive::http::Clock::now();
    }
    return newest_;
}

std::optional<Answer> MetricsSite::answer(const hive::http::Request& request, hive::http::Visit& visit)
{
    if (auto refused = refusal(request, visit))
        return refused;
    if (request.path == "/")
        return sentence(200, "The metrics of this swarm are at /metrics.");
    if (request.path != "/metrics")
        return sentence(404, "Not found.");
    const auto form = hive::metrics_form(request.accept);
    return Answer{.type = std::string(hive::media_type(form)), .body = hive::to_text(newest(visit.now), form)};
}

}  // namespace hivectl

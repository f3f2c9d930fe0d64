#include "site.hpp"

#include "event_stream.hpp"
#include "files.hpp"
#include "orders.hpp"
#include "words/output.hpp"

#include <charconv>

namespace hivectl::dash {
namespace {

using hive::http::sentence;
using namespace std::chrono_literals;

std::vector<std::string> split(std::string_view path)
{
    std::vector<std::string> words;
    while (!path.empty()) {
        path.remove_prefix(1);  // the slash
        const auto end = std::min(path.find('/'), path.size());
        words.emplace_back(path.substr(0, end));
        path.remove_prefix(end);
    }
    return words;
}

std::uint64_t number_in(const std::string& text)
{
    std::uint64_t number = 0;
    std::from_chars(text.data(), text.data() + text.size(), number);
    return number;
}

hive::http::Answer json(const hive::Json& value) { return {.type = "application/json", .body = json_text(value)}; }

/// The result of image_of.
hive::http::Answer image_answer(const hive::Json& result)
{
    if (result.contains("error"))
        return sentence(404, printable(result.at("error").at("text").get<std::string>()));
    return {.type = result.at("type").get<std::string>(),
            .bytes = std::make_shared<const std::vector<unsigned char>>(result.at("bytes").get_binary())};
}

hive::http::Answer nothing_here() { return sentence(404, "Not found."); }

/// Rounds to few widths, so that browsers of different sizes share an image.
int width_for(std::uint64_t box) { return box <= 320 ? 320 : box <= 640 ? 640 : 1280; }

}  // namespace

Site::Site(Settings settings)
    : settings_(std::move(settings)),
      watch_(settings_.home, 1s, [this] { wake(); }),
      orders_(settings_.home, settings_.timeout, [this] { wake(); }),
      questions_(settings_.home, settings_.timeout, [this] { wake(); }),
      images_(settings_.home, [this] { wake(); })
{
}

Site::Answer Site::refusal(const Request& request, const Visit& visit)
{
    return refusal_of_command(request, visit.bind, visit.pass, "Open the address that hivectl dash prints.");
}

std::size_t Site::takes(const Request& request, const Visit& visit)
{
    return request.method == "POST" && !refusal(request, visit) ? max_body : 0;
}

template <typename MakeWork>
Site::Answer Site::errand(Errands& errands, Visit& visit, MakeWork make_work, ToAnswer to_answer)
{
    if (!visit.again && (visit.mark = errands.begin(make_work())) == 0)
        return sentence(503, "Too many drones do not answer.");
    if (const auto result = errands.take(visit.mark))
        return to_answer(*result);
    return visit.late ? Answer(sentence(503, "There is no answer yet.")) : std::nullopt;
}

Site::Answer Site::answer(const Request& request, Visit& visit)
{
    if (auto refused = refusal(request, visit))
        return refused;
    const auto path = split(request.path);
    if (request.method == "GET")
        return answer_get(path, request, visit);
    if (request.path != "/orders")
        return nothing_here();
    try {
        return errand(
            orders_, visit, [&] { return order_in(request.body); }, json);
    } catch (const hive::Error& error) {
        return sentence(400, error.what());
    }
}

Site::Answer Site::answer_get(const Words& path, const Request& request, Visit& visit)
{
    if (request.path == "/" && visit.pass.in_address(request))
        return hive::http::Answer{
            .code = 303, .type = "text/plain; charset=utf-8", .body = "\n", .cookie = visit.pass.cookie()};
    if (const auto* file = file_at(request.path))
        return hive::http::Answer{.type = std::string(file->type), .body = std::string(file->text)};
    const auto snapshot = watch_.newest(visit.now);
    if (request.path == "/events")
        return events(visit);
    if (request.path == "/graph.svg")
        return drawing();
    if (path.size() == 4 && path[0] == "image")
        return image(path, visit);
    if (path.size() == 2 && path[0] == "drone" && snapshot)
        return json(drone_details(*snapshot, path[1]));
    if (path.size() == 2 && path[0] == "edge" && snapshot)
        return json(edge_details(*snapshot, path[1]));
    if (path.size() == 2 && path[0] == "ask")
        return errand(
            questions_, visit, [&] { return ask_of(path[1]); }, json);
    if (path.size() == 3 && path[0] == "failure")
        return errand(
            questions_, visit, [&] { return image_of(path[1], static_cast<std::int64_t>(number_in(path[2]))); },
            image_answer);
    if (path.size() == 3 && path[0] == "advice")
        return errand(
            questions_, visit, [&] { return advise_of(path[1], path[2]); }, json);
    if (path.size() == 3 && path[0] == "why")
        return errand(
            questions_, visit, [&] { return explain_of(path[1], path[2]); }, json);
    return nothing_here();
}

Site::Answer Site::events(const Visit& visit)
{
    if (visit.streams >= settings_.streams)
        return sentence(503, "Too many viewers.");
    return hive::http::Answer{.type = EventStream::type,
                              .stream = std::make_shared<EventStream>(
                                  [this](Watch::Time now) { return watch_.newest(now); }, settings_.repeat)};
}

Site::Answer Site::drawing() const
{
    const auto drawing = watch_.drawing();
    if (!drawing->problem.empty() || drawing->version == 0)
        return sentence(503, drawing->problem.empty() ? "The graph is being drawn." : drawing->problem);
    return hive::http::Answer{.type = "image/svg+xml", .body = drawing->svg};
}

/// Waits shortly for a newer image than the page has, so that a page requests no more often than it gets one.
Site::Answer Site::image(const Words& path, Visit& visit)
{
    constexpr std::uint64_t moment_ms = 250;
    const auto now_ms = static_cast<std::uint64_t>(visit.now.time_since_epoch() / 1ms);
    if (!visit.again)
        visit.mark = now_ms;
    const auto after = number_in(path[3]);
    auto newest = images_.newest(path[1], width_for(number_in(path[2])), after, visit.now);
    if (!newest.problem.empty())
        return sentence(503, printable(newest.problem));
    if (newest.version > after)
        return hive::http::Answer{
            .type = newest.type, .tag = "\"" + std::to_string(newest.version) + "\"", .bytes = newest.bytes};
    if (now_ms - visit.mark < moment_ms)
        return std::nullopt;
    return hive::http::Answer{.code = 204, .type = "text/plain"};
}

}  // namespace hivectl::dash

#include <hive/failure.hpp>

#include <sstream>

namespace hive {

Json failure_json(const Error& error, const std::string& drone)
{
    Json object{{"code", info(error.code()).token}, {"text", error.what()}};
    if (!error.advice().empty())
        object["advice"] = error.advice();
    if (!drone.empty())
        object["drone"] = drone;
    return {{"error", std::move(object)}};
}

std::optional<Error> failure_in(const std::string& printed)
{
    std::optional<Error> last;
    std::istringstream lines(printed);
    for (std::string line; std::getline(lines, line);)
        try {
            const auto object =
                line.starts_with('{') ? parse_json(line).value("error", Json::object()) : Json::object();
            const Fields fields(object, "a failure");
            last = Error(errc_from_token(fields.text("code")), fields.text("text"), fields.text_or("advice", ""));
        } catch (const Error&) {
            // ssh and the shell there may print other lines.
        }
    return last;
}

}  // namespace hive

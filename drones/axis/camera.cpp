// Makes the requests of VAPIX and checks the answers.
#include "camera.hpp"

namespace axis {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t max_image = 16u << 20, max_parameters = 65536;

const std::string& value_or_empty(const Parameters& values, const std::string& name)
{
    static const std::string empty;
    const auto found = values.find(name);
    return found == values.end() ? empty : found->second;
}

[[noreturn]] void not_an_image(const std::string& type)
{
    throw CameraError(Failure::not_an_image,
                      "not an image: the camera sends " + (type.empty() ? "data without a type" : masked(type)));
}

bool is_jpeg(const std::string& type) { return type.starts_with("image/jpeg") || type.starts_with("image/jpg"); }

/// The values in `wanted` that differ from `present`.
Parameters differences(const Parameters& wanted, const Parameters& present)
{
    Parameters result;
    for (const auto& [name, value] : wanted)
        if (value_or_empty(present, name) != value)
            result[name] = value;
    return result;
}

}  // namespace

Camera::Camera(const Access& access, std::function<void()> time) : http_(access), time_(std::move(time)) {}

std::string Camera::parameters(const std::string& query)
{
    return http_
        .get((admin_path_ ? "/axis-cgi/admin/param.cgi?" : "/axis-cgi/param.cgi?") + query,
             {.whole = 4s, .body = max_parameters}, time_)
        .body;
}

Model Camera::identify()
{
    const ParameterList list =
        parse_parameters(parameters(list_query({"Brand", "Properties.Firmware", "Properties.System"})));
    if (value_or_empty(list.values, "Brand.Brand").empty() && list.errors.empty())
        throw CameraError(Failure::not_vapix, "not a VAPIX device: it has param.cgi, but answers something else");
    return {value_or_empty(list.values, "Brand.ProdFullName"),
            value_or_empty(list.values, "Properties.Firmware.Version"),
            value_or_empty(list.values, "Properties.System.SerialNumber")};
}

Parameters Camera::list(const Parameters& names)
{
    std::vector<std::string> groups;
    for (const auto& [name, value] : names)
        groups.push_back(name);
    const ParameterList all = parse_parameters(parameters(list_query(groups)));
    Parameters result;
    for (const auto& [name, value] : names)
        if (const auto found = all.values.find(name); found != all.values.end())
            result.insert(*found);
    return result;
}

Parameters Camera::apply(const Parameters& wanted)
{
    if (wanted.empty())
        return {};
    const Parameters before = list(wanted);
    const Parameters changes = differences(wanted, before);
    if (changes.empty())
        return before;
    try {
        update(changes);
    } catch (const CameraError&) {
        const Parameters undo = differences(before, list(wanted));
        if (!undo.empty())
            update(undo);
        throw;
    }
    return list(wanted);
}

void Camera::update(const Parameters& values)
{
    std::string answer;
    try {
        answer = parameters(update_query(values));
    } catch (const CameraError& error) {
        if (admin_path_ || error.kind() != Failure::not_vapix)
            throw;
        admin_path_ = true;
        answer = parameters(update_query(values));
    }
    if (const auto reason = refusal_of(answer))
        throw CameraError(Failure::setting_refused, "the camera refuses: " + *reason);
}

std::string Camera::snapshot()
{
    Reply reply = http_.get("/axis-cgi/jpg/image.cgi", {.whole = 4s, .body = max_image}, time_);
    if (!is_jpeg(reply.type))
        not_an_image(reply.type);
    return std::move(reply.body);
}

void Camera::stream(const std::function<void(Part)>& take)
{
    std::optional<MultipartReader> reader;
    const auto take_all = [&] {
        while (auto part = reader->next()) {
            if (!part->type.empty() && !is_jpeg(part->type))
                not_an_image(part->type);
            take(std::move(*part));
        }
    };
    Sink sink;
    sink.time = time_;
    sink.head = [&](const Head& head) {
        const auto boundary = boundary_of(head.type);
        if (!boundary)
            not_an_image(head.type);
        reader.emplace(*boundary);
    };
    sink.bytes = [&](std::string_view bytes) {
        reader->feed(bytes);
        take_all();
    };
    http_.fetch("/axis-cgi/mjpg/video.cgi", {}, sink);
    reader->finish();
    take_all();
    throw CameraError(Failure::closed, "the camera ended the stream");
}

}  // namespace axis

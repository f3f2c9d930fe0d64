#include <hive/error.hpp>
#include <hive/event/failure_file.hpp>
#include <hive/event_text.hpp>
#include <hive/name.hpp>
#include <hive/protocol/packet.hpp>

#include <cerrno>
#include <cstring>
#include <fstream>

namespace hive::event {
namespace fs = std::filesystem;

using protocol::PacketType;

namespace {

constexpr protocol::Limits file_limits{.header = 64 * 1024, .body = max_failure_bytes};

void write_packet(std::ostream& out, PacketType type, const std::string& header, const Body& body)
{
    const auto prefix = protocol::encode({.type = type,
                                          .header_size = static_cast<std::uint32_t>(header.size()),
                                          .body_size = static_cast<std::uint32_t>(body.size())});
    out.write(reinterpret_cast<const char*>(prefix.data()), static_cast<std::streamsize>(prefix.size()));
    out << header;
    out.write(reinterpret_cast<const char*>(body.data()), static_cast<std::streamsize>(body.size()));
}

/// Reads the packets of a file, and never more bytes than the file has left.
class Packets {
public:
    explicit Packets(const fs::path& file)
    {
        // Opening a pipe would wait for its writer.
        std::error_code problem;
        if (!fs::is_regular_file(file, problem))
            throw problem ? Error(Errc::io, problem.message()) : Error(Errc::malformed, "it is not a regular file");
        in_.open(file, std::ios::binary);
        if (!in_)
            throw Error(Errc::io, std::strerror(errno));
        left_ = fs::file_size(file, problem);
        if (problem)
            throw Error(Errc::io, problem.message());
        require_at_most("the file", left_, max_failure_file_bytes);
    }

    [[nodiscard]] bool done() const { return left_ == 0; }
    protocol::Packet next(PacketType type, bool with_body)
    {
        const auto start = bytes(protocol::prefix_size);
        const auto prefix = protocol::decode_prefix(reinterpret_cast<const unsigned char*>(start.data()), file_limits);
        if (prefix.type != type)
            throw Error(Errc::malformed, "it has other packets than a kept failure");
        auto header = bytes(prefix.header_size);
        if (with_body)
            return protocol::make_packet(type, std::move(header), 0, Body(bytes(prefix.body_size)));
        take(prefix.body_size);
        in_.seekg(prefix.body_size, std::ios::cur);
        return protocol::make_packet(type, std::move(header));
    }

private:
    void take(std::uintmax_t size)
    {
        if (size > left_)
            throw Error(Errc::malformed, "it ends too early");
        left_ -= size;
    }
    std::string bytes(std::size_t size)
    {
        take(size);
        std::string text(size, '\0');
        if (!in_.read(text.data(), static_cast<std::streamsize>(size)))
            throw Error(Errc::malformed, "it ends too early");
        return text;
    }

    std::ifstream in_;
    std::uintmax_t left_ = 0;
};

Json about(const KeptFailure& failure)
{
    Json inputs = Json::array();
    for (const auto& event : failure.inputs)
        inputs.push_back(event.input);
    Json json{{"drone", failure.drone},
              {"time_us", failure.time_us},
              {"code", failure.code},
              {"text", failure.text},
              {"inputs", inputs}};
    if (!failure.kind.empty() || !failure.version.empty())
        json.update({{"kind", failure.kind}, {"version", failure.version}, {"parameters", failure.parameters}});
    return json;
}

}  // namespace

std::uintmax_t failure_file_bound(const KeptFailure& failure)
{
    std::uintmax_t bytes = file_limits.header + protocol::prefix_size;
    for (const auto& event : failure.inputs)
        bytes += event.body.size() + file_limits.header + protocol::prefix_size;
    return bytes;
}

void write_failure(std::ostream& out, const KeptFailure& failure)
{
    const auto text = to_text(about(failure));
    require_at_most("what is known of " + failure.drone, text.size(), file_limits.header);
    write_packet(out, PacketType::exception, text, {});
    for (const auto& event : failure.inputs)
        write_packet(out, PacketType::event, event_text(event), event.body);
}

KeptFailure read_failure(const fs::path& file, bool bodies)
{
    Packets packets(file);
    const Json about = parse_json(packets.next(PacketType::exception, true).header_text());
    const Fields fields(about, "a kept failure");
    KeptFailure failure{.drone = require_name(fields.text("drone"), "drone"),
                        .time_us = fields.integer("time_us", 0, max_json_integer),
                        .code = fields.text("code"),
                        .text = fields.text("text"),
                        .inputs = {},
                        .kind = fields.text_or("kind", ""),
                        .version = fields.text_or("version", "")};
    if (fields.has("parameters"))
        failure.parameters = fields.object("parameters");
    for (const auto& input : fields.array("inputs")) {
        const auto packet = packets.next(PacketType::event, bodies);
        Event event = event_from_text(packet.header_text(), packet.body);
        event.input = require_name(input.is_string() ? input.get<std::string>() : "", "input");
        failure.inputs.push_back(std::move(event));
    }
    if (!packets.done())
        throw Error(Errc::malformed, "it has more bytes than its inputs");
    return failure;
}

}  // namespace hive::event

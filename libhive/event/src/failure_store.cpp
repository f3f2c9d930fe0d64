// A file is DRONE,NUMBER,RUN,EDGE. It contains packets as on the wire: one about the failure, then one for each input.
#include <hive/error.hpp>
#include <hive/event/failure_store.hpp>
#include <hive/event_text.hpp>
#include <hive/name.hpp>
#include <hive/platform/process.hpp>
#include <hive/protocol/packet.hpp>
#include <hive/transport/folder_lock.hpp>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <set>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace hive::event {
namespace fs = std::filesystem;

using protocol::PacketType;

struct FailureStore::File {
    fs::path path;
    std::string drone;
    std::int64_t number = 0, run = 0;
    std::string edge;
    std::uintmax_t bytes = 0;
    fs::file_time_type time;
};

namespace {

constexpr protocol::Limits file_limits{.header = 64 * 1024, .body = 1u << 30};
constexpr std::string_view unfinished = ".new-";

[[noreturn]] void fail(const std::string& what) { throw Error(Errc::io, what + ": " + std::strerror(errno)); }

std::vector<std::string> fields_of_name(const std::string& name)
{
    std::vector<std::string> parts{""};
    for (const char c : name)
        c == ',' && parts.size() < 4 ? void(parts.emplace_back()) : parts.back().push_back(c);
    return parts;
}

std::int64_t number_of(const std::string& digits)
{
    std::int64_t number = -1;
    const auto end = digits.data() + digits.size();
    return std::from_chars(digits.data(), end, number).ptr == end ? number : -1;
}

void write_packet(std::ofstream& out, PacketType type, const std::string& header, const Body& body)
{
    const auto prefix = protocol::encode({.type = type,
                                          .header_size = static_cast<std::uint32_t>(header.size()),
                                          .body_size = static_cast<std::uint32_t>(body.size())});
    out.write(reinterpret_cast<const char*>(prefix.data()), static_cast<std::streamsize>(prefix.size()));
    out << header;
    out.write(reinterpret_cast<const char*>(body.data()), static_cast<std::streamsize>(body.size()));
}

void write_failure(const fs::path& file, const KeptFailure& failure)
{
    // Created with its mode, so that other users can never open it.
    const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (descriptor < 0)
        fail("cannot write " + file.string());
    ::close(descriptor);
    std::ofstream out(file, std::ios::binary);
    Json inputs = Json::array();
    for (const auto& event : failure.inputs)
        inputs.push_back(event.input);
    write_packet(out, PacketType::exception,
                 to_text(Json{{"drone", failure.drone},
                              {"time_us", failure.time_us},
                              {"code", failure.code},
                              {"text", failure.text},
                              {"inputs", inputs}}),
                 {});
    for (const auto& event : failure.inputs)
        write_packet(out, PacketType::event, event_text(event), event.body);
    if (out.flush().fail())
        fail("cannot write " + file.string());
}

std::string bytes_from(std::ifstream& in, std::size_t size)
{
    std::string bytes(size, '\0');
    if (!in.read(bytes.data(), static_cast<std::streamsize>(size)))
        throw Error(Errc::malformed, "a kept failure is truncated");
    return bytes;
}

protocol::Packet read_packet(std::ifstream& in, std::uintmax_t left, bool body)
{
    const auto prefix_bytes = bytes_from(in, protocol::prefix_size);
    const auto prefix =
        protocol::decode_prefix(reinterpret_cast<const unsigned char*>(prefix_bytes.data()), file_limits);
    if (prefix.header_size + std::uintmax_t(prefix.body_size) > left)
        throw Error(Errc::malformed, "a kept failure is truncated");
    auto header = bytes_from(in, prefix.header_size);
    if (body)
        return protocol::make_packet(prefix.type, std::move(header), 0, Body(bytes_from(in, prefix.body_size)));
    in.seekg(prefix.body_size, std::ios::cur);
    return protocol::make_packet(prefix.type, std::move(header));
}

void read_failure(const fs::path& file, std::uintmax_t size, bool bodies, KeptFailure& failure)
{
    std::ifstream in(file, std::ios::binary);
    const Json about = parse_json(read_packet(in, size, true).header_text());
    const Fields fields(about, "a kept failure");
    failure.time_us = fields.integer("time_us", 0, max_json_integer);
    failure.code = fields.text("code");
    failure.text = fields.text("text");
    for (const auto& input : fields.array("inputs")) {
        const auto packet = read_packet(in, size, bodies);
        Event event = event_from_text(packet.header_text(), packet.body);
        event.input = require_name(input.is_string() ? input.get<std::string>() : "", "input");
        failure.inputs.push_back(std::move(event));
    }
}

}  // namespace

FailureStore::FailureStore(const Home& home) : directory_(home.directory() / folder) {}

std::vector<FailureStore::File> FailureStore::files() const
{
    std::vector<File> found;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(directory_, ignored)) {
        const auto parts = fields_of_name(entry.path().filename().string());
        if (parts.size() != 4 || !is_name(parts[0]) || number_of(parts[1]) < 1 || number_of(parts[2]) < 0
            || !entry.is_regular_file(ignored))
            continue;
        found.push_back({.path = entry.path(),
                         .drone = parts[0],
                         .number = number_of(parts[1]),
                         .run = number_of(parts[2]),
                         .edge = parts[3],
                         .bytes = entry.file_size(ignored),
                         .time = entry.last_write_time(ignored)});
    }
    std::ranges::sort(found, [](const File& one, const File& other) {
        return one.number != other.number ? one.number < other.number : one.edge < other.edge;
    });
    return found;
}

std::int64_t FailureStore::keep(const KeptFailure& failure, const std::string& edge) const
{
    std::uintmax_t bytes = 0;
    for (const auto& event : failure.inputs)
        bytes += event.body.size() + file_limits.header;
    if (bytes > max_bytes)
        return 0;
    if (::mkdir(directory_.c_str(), 0700) != 0 && errno != EEXIST)
        fail("cannot make " + directory_.string());
    static std::atomic<int> writings = 0;
    const auto fresh =
        directory_ / (std::string(unfinished) + std::to_string(platform::own_pid()) + "-" + std::to_string(++writings));
    std::error_code problem;
    try {
        write_failure(fresh, failure);
    } catch (const Error&) {
        fs::remove(fresh, problem);
        throw;
    }
    const transport::FolderLock lock(directory_);  // not while bodies are written
    std::int64_t number = 0;
    for (const auto& file : files())
        if (file.drone == failure.drone) {
            const bool same = failure.run != 0 && file.run == failure.run;
            number = same ? file.number : std::max(number, file.number + 1);
            if (same)
                break;
        }
    number = std::max<std::int64_t>(number, 1);
    constexpr std::size_t max_edge = 128;  // so that the file name is valid on all file systems
    const auto name = failure.drone + "," + std::to_string(number) + "," + std::to_string(failure.run) + ","
                      + edge.substr(0, max_edge);
    fs::rename(fresh, directory_ / name, problem);
    if (problem) {
        fs::remove(fresh, problem);
        throw Error(Errc::io, "cannot keep " + (directory_ / name).string());
    }
    make_room();
    return number;
}

/// Removes the oldest failures of a drone that has too many, then the oldest of all, and files left by crashed writers.
void FailureStore::make_room() const
{
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(directory_, ignored)) {
        const auto name = entry.path().filename().string();
        if (name.starts_with(unfinished)
            && platform::process_ends(number_of(name.substr(unfinished.size(), name.rfind('-') - unfinished.size()))))
            fs::remove(entry.path(), ignored);
    }
    auto all = files();
    std::map<std::string, std::set<std::int64_t>> numbers;
    for (const auto& file : all)
        numbers[file.drone].insert(file.number);
    std::erase_if(all, [&](const File& file) {
        auto& of_drone = numbers[file.drone];
        while (of_drone.size() > max_failures)
            of_drone.erase(of_drone.begin());
        return !of_drone.contains(file.number) && fs::remove(file.path, ignored);
    });
    std::ranges::sort(all, std::greater(), &File::time);
    std::uintmax_t bytes = 0;
    std::size_t count = 0;
    for (const auto& file : all)
        if ((bytes += file.bytes) > max_bytes || ++count > max_files)
            fs::remove(file.path, ignored);
}

std::vector<std::string> FailureStore::drones() const
{
    std::set<std::string> names;
    for (const auto& file : files())
        names.insert(file.drone);
    return {names.begin(), names.end()};
}

std::vector<KeptFailure> FailureStore::read(const std::string& drone, bool bodies) const
{
    std::vector<KeptFailure> failures;
    for (const auto& file : files()) {
        if (file.drone != drone)
            continue;
        KeptFailure part{.drone = drone, .number = file.number, .run = file.run, .code = {}, .text = {}, .inputs = {}};
        try {
            read_failure(file.path, file.bytes, bodies, part);
        } catch (const Error&) {
            continue;  // removed meanwhile, or changed by hand
        }
        if (failures.empty() || failures.back().number != part.number) {
            failures.push_back(std::move(part));
            continue;
        }
        std::ranges::move(part.inputs, std::back_inserter(failures.back().inputs));
    }
    return failures;
}

}  // namespace hive::event

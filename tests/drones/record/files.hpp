// Recordings made for tests, in a folder that is gone at the end.
#pragma once

#include <hive/recording/reader.hpp>
#include <hive/recording/writer.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace record_test {

namespace fs = std::filesystem;
using Clock = hive::recording::Writer::Clock;

class Folder {
public:
    Folder()
    {
        std::string name = (fs::temp_directory_path() / "hive-record-XXXXXX").string();
        path_ = ::mkdtemp(name.data());
    }
    ~Folder() { fs::remove_all(path_); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    [[nodiscard]] fs::path operator/(const std::string& name) const { return path_ / name; }

private:
    fs::path path_;
};

inline std::string bytes_of(const fs::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_bytes(const fs::path& path, const std::string& bytes)
{
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

/// Event i of the test recordings: of two outputs in turn, 100 ms apart, the body "body i" three times.
inline std::string text_of(int i)
{
    return R"({"sender":"camera","output":")" + std::string(i % 2 ? "image" : "boxes") + R"(","type":"a/b","seq":)"
           + std::to_string(i) + "}";
}
inline std::string body_of(int i)
{
    const std::string word = "body " + std::to_string(i);
    return i % 2 ? word + word + word : "";
}

inline bool append(hive::recording::Writer& writer, int i, Clock::time_point begin = {})
{
    const std::string body = body_of(i);
    return writer.append({"camera", i % 2 ? "image" : "boxes", "a/b"}, text_of(i), std::as_bytes(std::span(body)), true,
                         begin + std::chrono::milliseconds(100 * i));
}

inline hive::recording::WriterSettings settings(const fs::path& path)
{
    return {.path = path, .overwrite = false, .limits = {}, .sync = std::chrono::milliseconds(0)};
}

/// The bytes of a recording with this many events.
inline std::string record(const fs::path& path, int events)
{
    {
        hive::recording::Writer writer(settings(path));
        for (int i = 0; i < events; ++i)
            append(writer, i);
        writer.finish("stopped");
    }
    return bytes_of(path);
}

struct Read {
    std::vector<std::string> texts, bodies;
    int damaged = 0;
    std::string problem;
};

inline Read read_all(hive::recording::Reader& reader)
{
    Read read;
    while (const auto record = reader.next())
        try {
            const std::string text = reader.text(*record);
            std::string body(record->prefix.body_size, '\0');
            reader.body(*record, std::as_writable_bytes(std::span(body)));
            read.texts.push_back(text);
            read.bodies.push_back(body);
        } catch (const std::runtime_error&) {
            ++read.damaged;
        }
    read.problem = reader.problem();
    return read;
}

}  // namespace record_test

// What a member may set never has a drone open a file: parameters that do are the operator's.
#include "subject.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <poll.h>
#include <stdexcept>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

using subject::Json;
using subject::within;

namespace {

namespace fs = std::filesystem;

/// Grey, 64 x 48: the code of a drone that reads a file at its first image runs.
std::string png()
{
    constexpr std::string_view digits =
        "89504e470d0a1a0a0000000d4948445200000040000000300800000000842023c3000000254944415478daedcc411100000c0220"
        "a31bdd10fbed2000e951040281402010080402c1d76030be005b6215e6350000000049454e44ae426082";
    std::string bytes;
    for (std::size_t i = 0; i < digits.size(); i += 2)
        bytes += static_cast<char>(std::stoi(std::string(digits.substr(i, 2)), nullptr, 16));
    return bytes;
}

/// A folder with a file and a FIFO, in which it is known whether something was opened or made.
class WatchedFolder {
public:
    WatchedFolder()
    {
        std::string pattern = (fs::temp_directory_path() / "hive-watched-XXXXXX").string();
        if (!::mkdtemp(pattern.data()))
            throw std::runtime_error("cannot make " + pattern);
        path_ = pattern;
        std::ofstream(path_ / "file.txt") << "secret\n";
        REQUIRE(::mkfifo((path_ / "fifo.txt").c_str(), 0600) == 0);
        REQUIRE(::inotify_add_watch(watch_, path_.c_str(), IN_OPEN | IN_ACCESS | IN_CREATE | IN_MODIFY) >= 0);
    }
    ~WatchedFolder()
    {
        ::close(watch_);
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    WatchedFolder(const WatchedFolder&) = delete;
    WatchedFolder& operator=(const WatchedFolder&) = delete;

    /// Values for a text parameter: a drone that takes one for a path opens or makes something here.
    [[nodiscard]] std::vector<std::string> texts() const
    {
        std::vector<std::string> texts;
        for (const auto* name : {"file.txt", "fifo.txt", "new.mp4", "new.json", ""})
            texts.push_back((path_ / name).string());
        return texts;
    }
    [[nodiscard]] bool touched(std::chrono::milliseconds timeout) const
    {
        pollfd ready{watch_, POLLIN, 0};
        return ::poll(&ready, 1, static_cast<int>(timeout.count())) > 0;
    }

private:
    fs::path path_;
    int watch_ = ::inotify_init1(IN_CLOEXEC | IN_NONBLOCK);
};

bool is_free_text(const Json& parameter) { return parameter.at("type") == "text" && !parameter.contains("choices"); }

}  // namespace

TEST_CASE("drone: a text parameter that is not the operator's is never taken for the path of a file")
{
    const WatchedFolder folder;
    const subject::Home home;
    auto process = home.start();
    for (const auto& parameter : subject::description().at("parameters")) {
        if (!is_free_text(parameter) || parameter.value("operator", false))
            continue;
        CAPTURE(parameter);
        for (const auto& text : folder.texts()) {
            CAPTURE(text);
            auto peer = home.meet();
            peer.ask(raw::set, {{"parameters", {{parameter.at("name"), text}}}});
            for (const auto& input : subject::image_inputs())
                peer.ask(raw::put, {{"input", input}, {"type", "image/png"}}, 0, png());
            CHECK_FALSE(folder.touched(std::chrono::milliseconds(100)));
            peer.ask(raw::set, {{"parameters", {{parameter.at("name"), parameter.at("default")}}}});
        }
    }
    // The watch notices what it is to notice.
    std::ifstream(folder.texts().front()).get();
    CHECK(folder.touched(std::chrono::milliseconds(1000)));
}

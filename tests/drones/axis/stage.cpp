// Starting, asking and looking.
#include "stage.hpp"

#include <hive/vision/image.hpp>

#include <doctest/doctest.h>

#include <fstream>
#include <stdexcept>
#include <sys/stat.h>

namespace stage {
namespace {

axis::Access access_to(int port)
{
    return {.url = {"http", "127.0.0.1", port},
            .credentials = {},
            .certificate = {},
            .addresses = axis::AddressRule("127.0.0.1")};
}

int number_after(const std::string& text, const std::string& word)
{
    const std::size_t at = text.find(word);
    return at == std::string::npos ? 0 : std::atoi(text.c_str() + at + word.size());
}

std::vector<std::string> command(std::vector<std::string> words)
{
    words.insert(words.begin(), emulator.begin(), emulator.end());
    return words;
}

}  // namespace

EmulatedCamera::EmulatedCamera(const Swarm& swarm, std::vector<std::string> words)
    : log_(swarm.home() / "camera.log"), process_(command(std::move(words)), {}, log_)
{
    REQUIRE(eventually([&] { return number_after(text_of(log_), "control at http://127.0.0.1:") > 0; }));
    port_ = number_after(text_of(log_), "camera at http://127.0.0.1:");
    control_port_ = number_after(text_of(log_), "control at http://127.0.0.1:");
}

std::string EmulatedCamera::control(const std::string& words) const
{
    const std::string answer = axis::Http(access_to(control_port_)).get("/?" + words, {}, [] {}).body;
    if (answer.starts_with('#'))
        throw std::runtime_error(answer);
    return answer;
}

void EmulatedCamera::behave(const std::string& words) const { control(words); }
int EmulatedCamera::count(const std::string& what) const { return number_after(control(""), "\n" + what + "="); }
std::string EmulatedCamera::parameter(const std::string& name) const
{
    return axis::Camera(access_to(port_)).list({{name, ""}}).at(name);
}

std::string credentials_file(const Swarm& swarm, const std::string& line)
{
    const auto path = swarm.home() / "credentials";
    std::ofstream(path) << line << "\n";
    ::chmod(path.c_str(), 0600);
    return path.string();
}

Process axis_drone(const Swarm& swarm, const EmulatedCamera& camera, std::vector<std::string> settings,
                   const std::vector<std::string>& environment)
{
    settings.insert(settings.end(), {"url=" + camera.url(), "allow_address=127.0.0.1"});
    return swarm.drone("axis", "axis", settings, {}, environment);
}

std::string condition(hive::Application& application) { return application.status("axis").condition; }

namespace {

/// Throws when it is broken.
void check_image(const hive::Event& event)
{
    const cv::Mat image = hive::vision::decode(event);
    CHECK(event.type == "image/jpeg");
    CHECK(image.cols == event.header.at("width"));
    CHECK(image.rows == event.header.at("height"));
}

bool says(hive::Application& application, const std::string& beginning)
{
    const std::string text = condition(application);
    return beginning.empty() ? text.empty() : text.starts_with(beginning);
}

}  // namespace

bool comes_to_say(hive::Application& application, const std::string& beginning, Milliseconds timeout)
{
    return eventually([&] { return says(application, beginning); }, timeout);
}

bool comes_to_say(hive::Application& application, hive::Collector& collector, const std::string& beginning,
                  Milliseconds timeout)
{
    return eventually(
        [&] {
            while (const auto event = collector.next(Milliseconds(1)))
                check_image(*event);
            return says(application, beginning);
        },
        timeout);
}

void take_images(hive::Collector& collector, int count, Milliseconds timeout)
{
    using namespace std::chrono;
    const auto begin = duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
    while (count > 0) {
        const auto event = collector.next(patient(timeout));
        if (!event)
            throw std::runtime_error("no image came");
        check_image(*event);
        count -= event->identity.captured_us > begin ? 1 : 0;
    }
}

}  // namespace stage

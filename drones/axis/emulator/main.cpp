// hive-axis-emulator: a camera that speaks VAPIX, for tests and for trying things out; it draws its images.
#include "server.hpp"

#include <opencv2/core/utility.hpp>

#include <charconv>
#include <iostream>
#include <stdexcept>

namespace {

using axis::emulator::ServerSettings;

constexpr const char* usage = R"(usage: hive-axis-emulator [name=value ...]
Emulates an Axis camera at http://127.0.0.1:PORT; prints where it listens.
  port=8080 control=8081    0, the default: any free ones
  address=127.0.0.1         that the camera listens at; the control stays on 127.0.0.1
  credentials=FILE          user:password of its owner; default root:pass
  auth=digest, stall_after=20 ...   how it behaves: drones/axis/emulator/README.md
)";

unsigned short port(const std::string& text)
{
    int number = -1;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (problem != std::errc() || end != text.data() + text.size() || number < 0 || number > 65535)
        throw std::invalid_argument("a port is a number from 0 to 65535");
    return static_cast<unsigned short>(number);
}

void take(ServerSettings& settings, const std::string& word)
{
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos)
        throw std::invalid_argument(word + ": write it as name=value");
    const std::string name = word.substr(0, equals), value = word.substr(equals + 1);
    if (name == "port")
        settings.port = port(value);
    else if (name == "control")
        settings.control_port = port(value);
    else if (name == "address")
        settings.address = value;
    else if (name == "credentials")
        settings.owner = axis::read_credentials(value).value_or(settings.owner);
    else
        settings.behaviour.set(name, value);
}

}  // namespace

int main(int argc, char** argv)
{
    try {
        cv::setNumThreads(1);
        ServerSettings settings;
        for (int i = 1; i < argc; ++i) {
            if (std::string(argv[i]) == "--help") {
                std::cout << usage;
                return 0;
            }
            take(settings, argv[i]);
        }
        axis::emulator::Server server(settings);
        std::cout << "camera at http://" << settings.address << ":" << server.port()
                  << "\ncontrol at http://127.0.0.1:" << server.control_port() << std::endl;
        server.run();
        return 0;
    } catch (const std::invalid_argument& problem) {
        std::cerr << "hive-axis-emulator: " << problem.what() << "\n" << usage;
        return 2;
    } catch (const std::exception& problem) {
        std::cerr << "hive-axis-emulator: " << problem.what() << "\n";
        return 1;
    }
}

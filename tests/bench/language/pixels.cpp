// The drones for the comparison with Python: a source of plain bytes on demand, what looks at them, what takes the
// result.
#include <hive/drone.hpp>

#include <cstring>
#include <iostream>
#include <map>
#include <string_view>
#include <vector>

namespace {

using namespace std::chrono_literals;

/// As a camera that copies its image into a loan.
void source(hive::Drone& drone)
{
    int bytes = 64;
    drone.parameter("bytes", bytes, hive::between(1, 16 << 20).in("B"), "of one image");
    const auto output = drone.output("image", "image/raw", "the bytes");
    std::vector<unsigned char> image(16 << 20, 7);
    drone.main([&]() -> std::chrono::microseconds {
        if (!output.asked())
            return 1s;
        hive::Loan loan = output.loan(static_cast<std::size_t>(bytes));
        std::memcpy(loan.data(), image.data(), static_cast<std::size_t>(bytes));
        output.emit_captured(std::chrono::system_clock::now(), true, {{"width", bytes}, {"height", 1}},
                             [&]() -> hive::Body { return std::move(loan); });
        return 0us;
    });
    drone.run();
}

/// Reads one word of each cache line, and says what they come to.
void look(hive::Drone& drone)
{
    const auto result = drone.output("result", "application/json", "the sum");
    drone.on_event("image", "image/raw", [&](const hive::Event& event) {
        std::uint64_t sum = 0, word = 0;
        for (std::size_t i = 0; i + sizeof word <= event.body.size(); i += 64) {
            std::memcpy(&word, event.body.data() + i, sizeof word);
            sum += word;
        }
        result.emit({{"sum", sum}});
    });
    drone.run();
}

/// Takes what they say, so that it is not held back.
void take(hive::Drone& drone)
{
    drone.on_event("result", "application/json", [](const hive::Event&) {});
    drone.run();
}

}  // namespace

int main(int argc, char** argv)
{
    const std::map<std::string_view, void (*)(hive::Drone&)> roles{{"source", source}, {"look", look}, {"take", take}};
    const auto role = argc > 1 ? roles.find(argv[1]) : roles.end();
    if (role == roles.end()) {
        std::cerr << "bench_pixels: the first word is source, look or take\n";
        return 2;
    }
    return hive::run_drone(argc - 1, argv + 1, {"pixels", "Part of a benchmark."}, role->second);
}

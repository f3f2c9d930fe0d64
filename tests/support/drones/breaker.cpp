// A drone for tests that fails at one event, in the way that its parameter selects.
#include <hive/drone.hpp>

#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>

// Not in an unnamed namespace, and not inlined: the tests search for this name.
namespace breaker {

[[gnu::noinline]] void write_to_null(volatile int* nowhere) { *nowhere = 1; }

void fail(const std::string& how)
{
    if (how == "null")
        write_to_null(nullptr);
    else if (how == "exit")
        std::quick_exit(3);
    else if (how == "hang")
        std::this_thread::sleep_for(std::chrono::hours(1));
    else if (how == "throw")
        throw std::runtime_error("broken, as told");
}

}  // namespace breaker

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {"breaker", "Fails at one event, for tests."}, [](hive::Drone& drone) {
        std::string how = "null";
        int at = 0, from = 0;
        drone.parameter("how", how, hive::one_of({"null", "exit", "hang", "throw", "none"}), "how it fails");
        drone.parameter("at", at, hive::at_least(0), "the sequence number of the event that it fails at");
        drone.parameter("from", from, hive::at_least(0), "if not 0: the first of all events that it fails at");
        bool matched = false;
        drone.parameter("matched", matched, {}, "has two inputs whose events belong together, in place of one");
        const auto seen = drone.output("seen", "application/json", "in the header: seq");
        const auto work = [&](const hive::Event& event) {
            const auto sequence = event.identity.sequence;
            if (sequence == at || (from > 0 && sequence >= from))
                breaker::fail(how);
            seen.emit({{"seq", sequence}});
        };
        if (const auto given = drone.given("matched"); !given || (*given != "true" && *given != true))
            drone.on_event("image", "*/*", work, "anything");
        else
            drone.on_matched({{"left", "*/*", "anything", {}}, {"right", "*/*", "what belongs to it", {}}},
                             hive::Match::exact(), [&](const std::vector<hive::Event>& set) { work(set.front()); });
        drone.run();
    });
}

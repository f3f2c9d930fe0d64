// A drone for tests that crashes in the way that its parameter selects, in the callback of an event or in its own
// thread.
#include <hive/drone.hpp>

#include <cstdlib>
#include <stdexcept>
#include <string>
#include <thread>

// Not in an unnamed namespace, and not inlined: the tests search for these names.
namespace crasher {

[[gnu::noinline]] void write_to_null(volatile int* nowhere) { *nowhere = 1; }

[[gnu::noinline]] void throw_uncaught() noexcept(false) { throw std::runtime_error("thrown by the crasher"); }

[[gnu::noinline]] int use_up_the_stack(volatile const int* depth)
{
    volatile const int here = *depth + 1;
    return here > 0 ? use_up_the_stack(&here) + here : 0;
}

/// Too large for a thread's cache, so that the corruption of the heap is detected while its lock is held.
[[gnu::noinline]] void free_twice()
{
    constexpr std::size_t size = 2000;
    void* volatile twice = std::malloc(size);
    void* const volatile behind = std::malloc(size);  // prevents merging with the rest of the heap
    std::free(twice);
    std::free(twice);
    std::free(behind);
}

[[gnu::noinline]] int call_null(int (*const volatile* function)()) { return (*function)() + 1; }

void crash(const std::string& how)
{
    volatile int depth = 0;
    int (*volatile null_function)() = nullptr;
    if (how == "null")
        write_to_null(nullptr);
    else if (how == "stack")
        depth = use_up_the_stack(&depth);
    else if (how == "heap")
        free_twice();
    else if (how == "call")
        depth = call_null(&null_function);
    else if (how == "abort")
        std::abort();
    else if (how == "throw")
        std::thread([] { throw_uncaught(); }).join();
}

}  // namespace crasher

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {"crasher", "Dies of each event, for tests."}, [](hive::Drone& drone) {
        std::string how = "null", at_start = "none";
        int from = 0;
        const auto kinds = hive::one_of({"null", "stack", "heap", "call", "abort", "throw", "none"});
        drone.parameter("how", how, kinds, "what each event does");
        drone.parameter("from", from, hive::at_least(0),
                        "only an event with this sequence number or one of the next 4 does it; 0: each");
        drone.parameter("at_start", at_start, kinds, "what the start does");
        drone.on_start([&] { crasher::crash(at_start); });
        drone.on_event(
            "in", "*/*",
            [&](const hive::Event& event) {
                if (from == 0 || (event.identity.sequence >= from && event.identity.sequence < from + 5))
                    crasher::crash(how);
            },
            "anything");
        drone.run();
    });
}

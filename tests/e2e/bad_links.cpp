// Streams and sources on demand over a link that loses, reorders, duplicates and damages packets. Slow, because random
// faults need time.
#include "bad_pair.hpp"
#include "lab.hpp"
#include "measure.hpp"
#include "switched_off.hpp"

#include <possible.hpp>

#include <cstdlib>
#include <functional>
#include <numeric>
#include <thread>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// Duration: longer by hand, with HIVE_TEST_SECONDS.
Seconds watching_time(int usual)
{
    const char* told = std::getenv("HIVE_TEST_SECONDS");
    return Seconds(told ? std::stoi(told) : usual);
}

/// No receiver has reconnected since these numbers were read; if this machine stalled, one may rightly have been
/// declared dead.
void check_kept(Pair& pair, const std::vector<std::int64_t>& before, const Watched& watched)
{
    const auto now = pair.registrations();
    const int again = std::inner_product(now.begin(), now.end(), before.begin(), 0, std::plus(), std::not_equal_to());
    CHECK_MESSAGE(again <= (watched.late > 500ms ? 1 : 0), "late by up to ", watched.late.count(), " s\n", pair.said());
}

/// Loads each core with this many busy threads.
class BusyCores {
public:
    explicit BusyCores(unsigned each)
    {
        for (unsigned i = 0; i < each * std::thread::hardware_concurrency(); ++i)
            threads_.emplace_back([](const std::stop_token& stop) {
                while (!stop.stop_requested()) {
                }
            });
    }

private:
    std::vector<std::jthread> threads_;
};

/// Results of a stream on a link of 20 Mbit/s with jitter, next to a plain connection on such a link.
struct Rounds {
    std::vector<double> ratios;        ///< of the rates
    std::vector<double> middle, most;  ///< the ages against what is allowed
    bool one_connection = false;
};

Rounds stream_at_20_megabits(int rounds)
{
    constexpr int frame = 100'000;
    Pair pair;
    pair.start("fps=40 bytes=" + std::to_string(frame));
    constexpr LineQuality quality{.delay = 10ms, .jitter = 1ms, .megabits = 20};
    pair.link().set(quality);
    const auto beside = pair.link_beside(quality);
    pair.connect("--stream");
    REQUIRE(eventually([&] { return pair.received() >= 40; }, 20'000ms));
    const auto registrations = pair.registrations();
    const auto plain = pair.plain_flow_beside();
    Rounds came;
    for (int round = 0; round < rounds; ++round) {
        const auto begin = Clock::now();
        const auto bytes = plain->received_bytes();
        const auto watched = watch(pair, 3s, frame);
        const auto plain_rate =
            static_cast<double>(plain->received_bytes() - bytes) / Seconds(Clock::now() - begin).count();
        came.ratios.push_back(watched.bytes_per_second / plain_rate);
        const auto three_frames = 3.0 * frame / watched.bytes_per_second;
        const auto kernel_and_link = (128.0 + 64.0) * 1024 / watched.bytes_per_second;
        came.middle.push_back(watched.age(0.5) / (three_frames + kernel_and_link));
        came.most.push_back(watched.age(0.95) / (2 * (three_frames + kernel_and_link)));
        MESSAGE("the stream " << watched.bytes_per_second / 1000 << " KB/s, " << came.ratios.back()
                              << " of a plain connection on such a link beside it; age of a frame " << watched.age(0.5)
                              << " s in the middle, of 95 % below " << watched.age(0.95) << " s; load "
                              << machine_load());
    }
    came.one_connection = pair.registrations() == registrations;
    return came;
}

}  // namespace

TEST_CASE(
    "bad link: at 5 % loss and 100 ms, streams under TLS keep TCP's own rate, their age is bounded, and nobody is "
    "taken for dead")
{
    if (!possible(missing_for_lab()))
        return;
    constexpr int streams = 4, frame = 40'000;
    Pair pair;
    pair.start("fps=20 bytes=" + std::to_string(frame), streams);
    pair.link().set({.delay = 50ms, .loss = 0.05});
    pair.connect("--stream");
    REQUIRE(eventually([&] { return pair.received() >= streams * 4; }, 20'000ms));
    const auto registrations = pair.registrations();
    std::vector<std::unique_ptr<PlainFlow>> plain;
    for (int i = 0; i < streams; ++i)
        plain.push_back(pair.plain_flow(9000 + i));
    const auto time = watching_time(40);
    const auto watched = watch(pair, time, frame);
    double plain_rate = 0;
    for (const auto& flow : plain)
        plain_rate += static_cast<double>(flow->received_bytes()) / time.count();
    const auto ratio = watched.bytes_per_second / plain_rate;
    MESSAGE("each stream " << watched.bytes_per_second / streams / 1000 << " KB/s, " << ratio
                           << " of a plain connection beside it; age of a frame " << watched.age(0.5)
                           << " s in the middle, of 95 % below " << watched.age(0.95) << " s; load " << machine_load());
    CHECK(ratio >= 0.8);
    check_kept(pair, registrations, watched);
    // Per receiver, one frame is passed to the connection and two wait, plus the data in the kernel.
    const auto three_frames = 3.0 * frame * streams / watched.bytes_per_second;
    const auto kernel = 48.0 * 1024 * streams / watched.bytes_per_second;
    CHECK(watched.age(0.5) < three_frames + 0.1);
    CHECK(watched.age(0.95) < 2 * (three_frames + kernel));
}

TEST_CASE("bad link: at 5 % loss and 100 ms, and with four busy threads for each core, nobody is taken for dead")
{
    if (!possible(missing_for_lab()))
        return;
    constexpr int streams = 4, event = 1000;  // small: four losses of one packet cause 2 s of silence as well
    Pair pair;
    pair.start("fps=5 bytes=" + std::to_string(event), streams);
    pair.link().set({.delay = 50ms, .loss = 0.05});
    pair.connect("--stream");
    REQUIRE(eventually([&] { return pair.received() >= streams * 4; }, 20'000ms));
    const auto registrations = pair.registrations();
    const BusyCores busy(4);
    const auto watched = watch(pair, watching_time(20), event);
    MESSAGE("each stream " << watched.bytes_per_second / streams / event << " events/s; this thread was late by "
                           << watched.late.count() << " s at most; load " << machine_load());
    check_kept(pair, registrations, watched);
}

TEST_CASE("bad link: at 20 Mbit/s with jitter a stream keeps TCP's own rate, and its age is bounded")
{
    if (!possible(missing_for_lab()))
        return;
    const auto came = stream_at_20_megabits(3);
    CHECK(median(came.ratios) >= 0.8);
    CHECK(came.one_connection);
    CHECK(median(came.middle) < 1);
    CHECK(median(came.most) < 1);
}

TEST_CASE("bad link: when a receiver that is behind is given all that waits, what it gets is too old")
{
    if (!possible(missing_for_lab()))
        return;
    const SwitchedOff most_behind("most-behind");
    CHECK(stream_at_20_megabits(1).middle.front() > 1);
}

TEST_CASE("bad link: when the kernel may take what it likes, what arrives is too old")
{
    if (!possible(missing_for_lab()))
        return;
    const SwitchedOff unsent_limit("unsent-limit");
    CHECK(stream_at_20_megabits(1).middle.front() > 1);
}

TEST_CASE("bad link: what is doubled, overtaken and lost on the way comes once and in order")
{
    if (!possible(missing_for_lab()))
        return;
    constexpr std::int64_t events = 400;
    Pair pair;
    pair.start("pace=demand count=" + std::to_string(events));
    pair.link().set({.delay = 10ms, .jitter = 8ms, .loss = 0.01, .duplication = 0.1});
    const auto results = pair.results();
    pair.connect("--window 16");
    std::vector<std::int64_t> numbers;
    while (static_cast<std::int64_t>(numbers.size()) < events)
        if (const auto event = results->next(patient(15'000ms)))
            numbers.push_back(event->header.at("index").get<std::int64_t>());
        else
            break;
    CHECK_FALSE(results->next(200ms));  // and nothing twice
    std::vector<std::int64_t> all(events);
    std::iota(all.begin(), all.end(), 1);
    CHECK(numbers == all);
    CHECK(pair.link().counts().duplicated > 0);
}

TEST_CASE("bad link: under TLS no damaged body is taken for a good one, not even where TCP's checksum sees nothing")
{
    if (!possible(missing_for_lab()))
        return;
    Pair pair;
    pair.start("fps=50 bytes=60000");
    pair.link().set({.delay = 2ms});
    pair.connect("--stream");
    REQUIRE(eventually([&] { return pair.received() >= 10; }));
    const auto registrations = pair.registrations();
    const auto go_on = [&](const LineQuality& quality, std::int64_t damaged) {
        pair.link().set(quality);
        const auto until = pair.link().counts().damaged + damaged, before = pair.received();
        CHECK(eventually([&] { return pair.link().counts().damaged >= until; }, 30'000ms));
        pair.link().set({.delay = 2ms});
        const auto then = pair.received();
        CHECK(eventually([&] { return pair.received() >= then + 20; }, 10'000ms));
        return pair.received() - before;
    };
    const auto with_bits = go_on({.delay = 2ms, .corruption = 0.005, .damage = LineQuality::Damage::bit}, 20);
    CHECK(pair.registrations() == registrations);  // TCP sends them again
    const auto with_words = go_on({.delay = 2ms, .corruption = 0.0005, .damage = LineQuality::Damage::words}, 10);
    CHECK(pair.registrations() != registrations);  // TLS ends the connection
    CHECK(pair.sum(&hive::InputStatus::abandoned) == 0);
    MESSAGE("20 packets with a wrong bit, and " << with_bits << " events; then 10 with exchanged words, and "
                                                << with_words << " events; none was wrong");
}

TEST_CASE("bad link: without TLS, damage that TCP's checksum does not see is in what arrives")
{
    if (!possible(missing_for_lab()))
        return;
    Pair pair(Key::none);
    pair.start("fps=50 bytes=60000");
    pair.connect("--stream");
    pair.link().set({.corruption = 0.0005, .damage = LineQuality::Damage::words});
    CHECK(eventually([&] { return pair.sum(&hive::InputStatus::abandoned) > 0; }, 30'000ms));
}

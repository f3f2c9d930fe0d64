// hivectl dash with many drones, over two machines, and while drones are replaced: in a real browser.
#include "dash_browser.hpp"
#include "lab.hpp"

#include <doctest/doctest.h>

using namespace hive::test;
using namespace std::chrono_literals;

TEST_CASE("dash in a browser: a drone that is replaced keeps its images and takes parameters")
{
    if (!possible(missing_for_browser()))
        return;
    const Swarm swarm;
    const auto done = swarm.run(browser_words("dash_people", "replaced"), 90'000ms);
    CHECK_MESSAGE(done.exit_code == 0, done.out, done.err);
}

TEST_CASE("dash in a browser: 300 drones")
{
    if (!possible(missing_for_browser()))
        return;
    const Swarm swarm;
    const auto done = swarm.run(browser_words("dash_people", "hundreds"), 120'000ms);
    CHECK_MESSAGE(done.exit_code == 0, done.out, done.err);
    MESSAGE(done.out);
}

TEST_CASE("dash in a browser: a drone on another machine is shown and changed, and only shown to a viewer's key")
{
    if (!possible(missing_for_browser()) || !possible(missing_for_lab()))
        return;
    const Lab lab({"cam1"});
    lab.share_key();
    const auto done = lab.shell("exec python3 " HIVE_SOURCE_DIR "/tests/e2e/dash_people.py machines cam1", 90'000ms);
    CHECK_MESSAGE(done.exit_code == 0, done.out, done.err);
}

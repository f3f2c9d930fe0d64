// A new process in the place of a drone that runs.
#include "application_object.hpp"
#include "texts.hpp"
#include "waiting.hpp"

#include <hive_swarm.h>

#include <hive/replace.hpp>

using namespace hive;
using namespace hive::c;

namespace {

ReplaceOptions replace_options(const char* text)
{
    const Options given(text, {"kind", "parameters", "arguments", "ready_ms", "lose_state"});
    ReplaceOptions options;
    options.kind = given.text("kind");
    options.parameters = given.object("parameters");
    options.arguments = given.texts("arguments");
    options.ready_within = patience_of(given.integer("ready_ms", 0, options.ready_within.count()));
    options.lose_state = given.flag("lose_state");
    options.cancelled = wait_is_cancelled;
    return options;
}

}  // namespace

hive_code hive_application_replace(hive_application* application, const char* drone, const char* options,
                                   hive_log_callback last_words, void* user, char** replaced)
{
    return with_application(application, [&](Application& open) {
        auto wanted = replace_options(options);
        wanted.home = open.home();
        if (last_words)
            wanted.last_words = [&](const std::string& line) { last_words(user, line.c_str()); };
        const auto done = replace(open, text_of(drone, "the drone"), wanted);
        if (replaced)
            give_json({{"drone", done.drone},
                       {"kind", done.kind},
                       {"pid", done.pid},
                       {"before", done.before},
                       {"log", done.log.string()}},
                      replaced);
    });
}

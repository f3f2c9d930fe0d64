// The list of verbs. To add one: a file under commands/, with its own namespace, and one line here.
#pragma once

#include "verb.hpp"

#include <string_view>
#include <vector>

// In the order of `hivectl --help`, by group.
#define HIVECTL_VERBS(VERB)                                                                                            \
    VERB(start)                                                                                                        \
    VERB(stop)                                                                                                         \
    VERB(replace)                                                                                                      \
    VERB(ps)                                                                                                           \
    VERB(describe)                                                                                                     \
    VERB(devices)                                                                                                      \
    VERB(wait)                                                                                                         \
    VERB(place)                                                                                                        \
    VERB(logs)                                                                                                         \
    VERB(check)                                                                                                        \
    VERB(schema)                                                                                                       \
    VERB(up)                                                                                                           \
    VERB(down)                                                                                                         \
    VERB(export)                                                                                                       \
    VERB(connect)                                                                                                      \
    VERB(disconnect)                                                                                                   \
    VERB(connections)                                                                                                  \
    VERB(graph)                                                                                                        \
    VERB(set)                                                                                                          \
    VERB(get)                                                                                                          \
    VERB(results)                                                                                                      \
    VERB(collect)                                                                                                      \
    VERB(snap)                                                                                                         \
    VERB(view)                                                                                                         \
    VERB(dash)                                                                                                         \
    VERB(put)                                                                                                          \
    VERB(top)                                                                                                          \
    VERB(record)                                                                                                       \
    VERB(save)                                                                                                         \
    VERB(replay)                                                                                                       \
    VERB(audit)                                                                                                        \
    VERB(explain)                                                                                                      \
    VERB(advise)                                                                                                       \
    VERB(metrics)                                                                                                      \
    VERB(exceptions)                                                                                                   \
    VERB(rerun)                                                                                                        \
    VERB(halt)                                                                                                         \
    VERB(resume)                                                                                                       \
    VERB(key)                                                                                                          \
    VERB(completion)                                                                                                   \
    VERB(complete)

namespace hivectl {

#define HIVECTL_DECLARE(name)                                                                                          \
    namespace name##_verb { Verb verb(); }
HIVECTL_VERBS(HIVECTL_DECLARE)
#undef HIVECTL_DECLARE

/// All verbs; created when called, so nothing runs before main.
std::vector<Verb> verbs();

/// Declares the options of the verb and the common ones.
Run declared(const Verb& verb, CommandLine& line, Session& session);

/// The verb of that name or alias, or nullptr.
const Verb* verb_named(const std::vector<Verb>& all, std::string_view name);

}  // namespace hivectl

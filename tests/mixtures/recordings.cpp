#include "recordings.hpp"

#include <hive/event_text.hpp>
#include <hive/recording/reader.hpp>

namespace hive::mixtures {
namespace {

void read(const std::filesystem::path& file, const Numbering& numbering, Received& received)
try {
    const auto note = [&](const std::string& text) { received.wrong.push_back(file.filename().string() + " " + text); };
    recording::Reader reader(file);
    while (const auto record = reader.next()) {
        const auto event = event_from_text(reader.text(*record));
        ++received.times[{numbering.run_of(event.identity.epoch), event.header.at("index")}];
    }
    if (!reader.problem().empty())
        note("is damaged: " + reader.problem());
    if (reader.summary().ended.empty())
        note("has no end");
    for (const auto& loss : reader.summary().lost)
        note("has lost " + std::to_string(loss.events) + " events: " + loss.reason);
} catch (const std::exception& error) {
    received.wrong.push_back(file.filename().string() + ": " + error.what());
}

}  // namespace

Received recorded_in(const std::filesystem::path& folder, const Numbering& numbering)
{
    Received received{.way = {recorder}, .what = "the recordings"};
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".hive")
            read(entry.path(), numbering, received);
    return received;
}

}  // namespace hive::mixtures

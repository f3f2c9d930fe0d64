// Shows the smoothed rate of the last second; queries the total from the sources.
#include "words/progress.hpp"

#include "words/format.hpp"
#include "words/output.hpp"
#include "words/status_line.hpp"

#include <algorithm>
#include <cmath>

namespace hivectl {

using namespace std::chrono_literals;

std::string progress_text(std::int64_t done, std::int64_t all, double per_second)
{
    std::string text = std::to_string(done) + (all > 0 ? " of " + std::to_string(all) : "") + " frames";
    if (all > 0)
        text += ", " + std::to_string(100 * std::min(done, all) / all) + " %";
    if (per_second > 0)
        text += ", " + tenths_text(per_second) + "/s";
    if (all > done && per_second > 0)
        text += ", "
                + duration_text(static_cast<std::int64_t>(std::ceil(static_cast<double>(all - done) / per_second))
                                * 1'000'000)
                + " left";
    return text;
}

Progress::Progress(hive::Application& application, bool beside_results)
    : application_(application), shown_(status_line::possible() && !(beside_results && on_terminal()))
{
    status_line::take_over();
}

Progress::~Progress()
{
    if (shown_)
        status_line::erase();
}

void Progress::note(const hive::Identity& identity)
{
    Place& place = places_[identity.source];
    if (identity.epoch < place.epoch)
        return;
    const bool first = identity.epoch > place.epoch;  // an earlier position is not work
    work_ += first ? 1 : std::max<std::int64_t>(0, identity.sequence - place.sequence);
    place = {identity.epoch, first ? identity.sequence : std::max(place.sequence, identity.sequence)};
    advance(identity.source, place.sequence);
}

void Progress::note(const std::string& source, std::int64_t done)
{
    work_ = done;
    advance(source, done);
}

void Progress::advance(const std::string& source, std::int64_t done)
{
    source_ = source;
    done_ = done;
    if (shown_ && Clock::now() - last_ >= 500ms)
        show();
}

void Progress::show()
{
    const auto now = Clock::now();
    const double rate = static_cast<double>(work_ - before_) / std::chrono::duration<double>(now - last_).count();
    per_second_ = per_second_ > 0 ? 0.7 * per_second_ + 0.3 * rate : rate;
    before_ = work_;
    last_ = now;
    const auto all = all_of(source_);
    status_line::show(progress_text(all > 0 ? done_ : work_, all, per_second_));
}

/// Queried once; a source that does not answer in time has no total.
std::int64_t Progress::all_of(const std::string& source)
{
    const auto [place, fresh] = all_.try_emplace(source, 0);
    if (fresh) {
        application_.timeout(300ms);
        const auto answer = application_.status(std::vector{source}).at(0);
        place->second = value_or_none(answer.status).source_events;
    }
    return place->second;
}

}  // namespace hivectl

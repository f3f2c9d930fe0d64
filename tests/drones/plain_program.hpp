// What one program without Hive makes of the same frames with the same algorithms, to compare a swarm with.
#pragma once

#include <swarm.hpp>

#include <doctest/doctest.h>
#include <foreground_finder.hpp>
#include <opencv2/core/utility.hpp>
#include <scene.hpp>

#include <map>
#include <vector>

namespace hive::test {

/// The frames of the camera's scene by sequence, from 1.
inline auto scene_frames(const camera::SceneSettings& settings)
{
    return [scene = camera::Scene(settings)](std::int64_t sequence) { return scene.frame(sequence - 1).image; };
}

/// The results of `of(sequence, foreground, frame)` for this many frames, by sequence.
template <class Frame, class Of>
std::map<std::int64_t, Json> plain_program(Frame frame, background::ForegroundFinder finder, std::int64_t first,
                                           int frames, Of of)
{
    cv::setNumThreads(1);  // as the drones
    std::map<std::int64_t, Json> result;
    for (std::int64_t sequence = first; sequence < first + frames; ++sequence) {
        const cv::Mat image = frame(sequence);
        result[sequence] = of(sequence, finder.find(image), image);
    }
    return result;
}

/// Checks that each of so many results has in `field` what the plain program has that begins with the first one's
/// frame; returns their headers.
template <class Plain>
std::vector<Json> checked_headers(Collector& collector, const char* field, int frames, Plain plain)
{
    std::map<std::int64_t, Json> expected;
    std::vector<Json> headers;
    for (int seen = 0; seen < frames; ++seen) {
        const auto event = collector.next(patient(Milliseconds(5000)));
        REQUIRE(event);
        if (seen == 0)
            expected = plain(event->identity.sequence);
        const auto frame = event->identity.sequence;
        REQUIRE_MESSAGE(expected.contains(frame), "frame ", frame);
        CHECK_MESSAGE(event->header.at(field) == expected.at(frame), "frame ", frame);
        expected.erase(frame);  // no frame is repeated, so all arrive
        headers.push_back(event->header);
    }
    return headers;
}

}  // namespace hive::test

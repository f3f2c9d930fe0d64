// What one program without Hive makes of the same pictures with the same algorithms, to compare a swarm with.
#pragma once

#include <swarm.hpp>

#include <doctest/doctest.h>
#include <foreground_finder.hpp>
#include <opencv2/core/utility.hpp>
#include <scene.hpp>

#include <map>
#include <vector>

namespace hive::test {

/// The pictures of the camera's scene by sequence, which begins at 1.
inline auto scene_pictures(const camera::SceneSettings& settings)
{
    return [scene = camera::Scene(settings)](std::int64_t sequence) { return scene.picture(sequence - 1).image; };
}

/// By sequence: what `of(sequence, foreground, picture)` makes of each of so many pictures.
template <class Picture, class Of>
std::map<std::int64_t, Json> plain_program(Picture picture, background::ForegroundFinder finder, std::int64_t first,
                                           int pictures, Of of)
{
    cv::setNumThreads(1);  // as the drones
    std::map<std::int64_t, Json> result;
    for (std::int64_t sequence = first; sequence < first + pictures; ++sequence) {
        const cv::Mat image = picture(sequence);
        result[sequence] = of(sequence, finder.find(image), image);
    }
    return result;
}

/// Checks that each of so many results has in `field` what the plain program has that begins with the first one's
/// picture; returns their headers.
template <class Plain>
std::vector<Json> checked_headers(Collector& collector, const char* field, int pictures, Plain plain)
{
    std::map<std::int64_t, Json> expected;
    std::vector<Json> headers;
    for (int seen = 0; seen < pictures; ++seen) {
        const auto event = collector.next(patient(Milliseconds(5000)));
        REQUIRE(event);
        if (seen == 0)
            expected = plain(event->identity.sequence);
        const auto picture = event->identity.sequence;
        REQUIRE_MESSAGE(expected.contains(picture), "picture ", picture);
        CHECK_MESSAGE(event->header.at(field) == expected.at(picture), "picture ", picture);
        expected.erase(picture);  // none comes twice, so all come
        headers.push_back(event->header);
    }
    return headers;
}

}  // namespace hive::test

// Finds skin, then places for palms, then examines each.
#include "hand_search.hpp"

#include <cascade.hpp>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gesture {
namespace {

/// Images are reduced to at most this many px per side for face detection: smaller faces are too far away to read the
/// hand.
constexpr double face_image = 640;
/// Of a palm's disc, in widths of the face (as the cascade frames it), and without a face in shorter sides of the
/// image.
constexpr double smallest_by_face = 0.14, default_by_face = 0.26, largest_by_face = 0.42, smallest_by_image = 0.02,
                 largest_by_image = 0.22;
constexpr double smallest_place = 5;  ///< px
/// A wall may have nearly the colour of skin: then a stricter look parts the hand from it.
constexpr std::array<double, 3> strictnesses{1, 0.6, 0.35};
constexpr std::size_t max_places = 30;
/// In radii of the palm: how far a hand reaches from its middle; how large the close look is, px.
constexpr double reach = 3.3, close_radius = 46;
constexpr double largest_enlargement = 6;
constexpr double close_tolerance = 3;  ///< standard deviations
/// Of the skin of a face or region, which is in other light than the hand, and of that of a palm.
constexpr SkinColour::Spread of_somebody{28, 4}, of_a_palm{16, 3.5};
constexpr int close_smooth = 7;  ///< px of the close look
/// How much larger a palm may turn out to be, and how much of what is within reach a hand and its arm may cover.
constexpr double min_grown = 0.6, max_grown = 1.5, max_share = 0.6;
/// Of a place, if no model decides: a fist needs an arm, and the colour and size of the person. Else it is an elbow, or
/// a piece of wall.
constexpr double min_worth = 0.3;

cv::Rect within(const cv::Rect& part, const cv::Mat& image) { return part & cv::Rect({}, image.size()); }

/// Cheeks, nose and mouth of a face, without eyes and hair.
cv::Rect skin_of(const cv::Rect& face)
{
    return {face.x + face.width / 5, face.y + face.height * 2 / 5, face.width * 3 / 5, face.height * 2 / 5};
}

/// Blackens a face with its neck.
void leave_out(cv::Mat& mask, const cv::Rect& face)
{
    const cv::Point middle(face.x + face.width / 2, face.y + face.height / 2);
    cv::ellipse(mask, middle, {face.width * 62 / 100, face.height * 80 / 100}, 0, 0, 360, 0, cv::FILLED);
    const cv::Rect neck(face.x + face.width / 6, middle.y, face.width * 2 / 3, face.height * 11 / 10);
    cv::rectangle(mask, neck, 0, cv::FILLED);
}

cv::Mat filled(cv::Size size, const cv::Rect& part)
{
    cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
    mask(part & cv::Rect({}, size)) = 255;
    return mask;
}

cv::Mat disc(cv::Size size, cv::Point middle, double radius)
{
    cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
    cv::circle(mask, middle, std::max(1, static_cast<int>(radius)), 255, cv::FILLED);
    return mask;
}

/// The hand that was read in an enlarged part, in px of the image.
void move_back(Hand& hand, const cv::Point& corner, double scale)
{
    const auto place = [&](const cv::Point& point) {
        return cv::Point(corner.x + cvRound(point.x / scale), corner.y + cvRound(point.y / scale));
    };
    hand.box = {place(hand.box.tl()), place(hand.box.br())};
    hand.palm = place(hand.palm);
    hand.radius /= scale;
    for (cv::Point& tip : hand.tips)
        tip = place(tip);
}

}  // namespace

void HandSearch::load_faces(const std::string& cascade_path)
{
    cascade_ = cascade_path.empty() ? cv::CascadeClassifier() : cascade::load(cascade_path);
}

std::vector<Hand> HandSearch::find(const cv::Mat& image)
{
    const auto faces = faces_in(image);
    const auto known = known_skin(image, faces);
    const double side = std::min(image.cols, image.rows);
    double smallest = smallest_by_image * side, largest = largest_by_image * side;
    if (!faces.empty()) {
        smallest = smallest_by_face * faces[0].width;
        largest = largest_by_face * faces[0].width;
    }
    std::vector<Candidate> candidates;
    for (const double strictness : strictnesses) {
        if (!known && strictness < 1)
            break;
        const cv::Mat skin = skin_in(image, known, strictness * tolerance, faces);
        for (const Place& place : places_in(skin, std::max(smallest_place, smallest), largest))
            if (auto candidate = examine(image, skin, place)) {
                if (known)
                    candidate->worth -= 0.3 * known->distance(candidate->skin);
                if (!faces.empty())
                    candidate->worth -= std::abs(std::log(candidate->hand.radius / (default_by_face * faces[0].width)));
                candidates.push_back(std::move(*candidate));
            }
    }
    return best_of(std::move(candidates));
}

/// The largest first.
std::vector<cv::Rect> HandSearch::faces_in(const cv::Mat& image)
{
    std::vector<cv::Rect> faces;
    if (cascade_.empty())
        return faces;
    cv::Mat grey;
    cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
    const double scale = std::min(1.0, face_image / std::max(grey.cols, grey.rows));
    if (scale < 1)
        cv::resize(grey, grey, {}, scale, scale, cv::INTER_AREA);
    cascade_.detectMultiScale(grey, faces, 1.1, 5, 0, {24, 24});
    for (cv::Rect& face : faces)
        face = {cvRound(face.x / scale), cvRound(face.y / scale), cvRound(face.width / scale),
                cvRound(face.height / scale)};
    std::ranges::stable_sort(faces, std::ranges::greater{}, &cv::Rect::width);
    return faces;
}

/// That of the region, or else of the largest face.
std::optional<SkinColour> HandSearch::known_skin(const cv::Mat& image, const std::vector<cv::Rect>& faces) const
{
    cv::Rect known = within(region, image);
    if (known.empty() && !faces.empty())
        known = within(skin_of(faces[0]), image);
    return SkinColour::learn(image, filled(image.size(), known), of_somebody);
}

cv::Mat HandSearch::skin_in(const cv::Mat& image, const std::optional<SkinColour>& known, double deviations,
                            const std::vector<cv::Rect>& faces) const
{
    cv::Mat mask;
    if (known)
        mask = known->mask(image, deviations);
    else {
        Silhouette silhouette;
        silhouette.from = "skin";
        silhouette.skin = range;
        mask = silhouette.of(image);
    }
    cv::medianBlur(mask, mask, 3);
    const int gap = std::max(3, std::max(image.cols, image.rows) / 80);
    cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, cv::getStructuringElement(cv::MORPH_ELLIPSE, {gap, gap}));
    for (const cv::Rect& face : faces)
        leave_out(mask, face);
    return mask;
}

/// The middles of the largest discs that fit into the skin, none within another.
std::vector<HandSearch::Place> HandSearch::places_in(const cv::Mat& skin, double smallest, double largest)
{
    cv::Mat framed, depth;
    cv::copyMakeBorder(skin, framed, 1, 1, 1, 1, cv::BORDER_CONSTANT, 0);  // the border of the image is an edge
    cv::distanceTransform(framed, depth, cv::DIST_L2, 5);
    std::vector<Place> places;
    for (std::size_t looked_at = 0; looked_at < 4 * max_places && places.size() < max_places; ++looked_at) {
        double radius = 0;
        cv::Point middle;
        cv::minMaxLoc(depth, nullptr, &radius, nullptr, &middle);
        if (radius < smallest)
            break;
        cv::circle(depth, middle, static_cast<int>(1.3 * radius), 0, cv::FILLED);
        if (radius <= largest)
            places.push_back({middle - cv::Point(1, 1), radius});
    }
    return places;
}

std::optional<HandSearch::Candidate> HandSearch::examine(const cv::Mat& image, const cv::Mat& skin, const Place& place)
{
    const int half = static_cast<int>(std::ceil(reach * place.radius)) + 2;
    const cv::Rect part = within({place.middle.x - half, place.middle.y - half, 2 * half + 1, 2 * half + 1}, image);
    const auto learnt = SkinColour::learn(
        image(part), disc(part.size(), place.middle - part.tl(), 0.8 * place.radius) & skin(part), of_a_palm);
    if (!learnt)
        return std::nullopt;
    const double scale = std::min(largest_enlargement, close_radius / place.radius);
    cv::Mat close;
    cv::resize(image(part), close, {}, scale, scale, scale > 1 ? cv::INTER_CUBIC : cv::INTER_AREA);
    const cv::Point middle((place.middle - part.tl()) * scale);
    const double radius = place.radius * scale;
    const cv::Mat mask = learnt->mask(close, close_tolerance) & disc(close.size(), middle, reach * radius);
    GestureFinder finder;
    finder.smooth = close_smooth;
    const auto reading = finder.read_at(mask, middle, radius);
    if (!reading || reading->arms > 1)
        return std::nullopt;
    const double grown = reading->hand.radius / radius,
                 share = cv::countNonZero(mask) / (std::numbers::pi * std::pow(reach * radius, 2));
    if (grown < min_grown || grown > max_grown || share > max_share)
        return std::nullopt;  // no hand before something else, but a part of something large
    Candidate candidate{reading->hand, *learnt, 0};
    const double fingers = static_cast<double>(candidate.hand.tips.size());
    candidate.worth = (fingers > 0 ? 1 : 0) + 0.1 * fingers + (reading->arms == 1 ? 0.5 : 0);
    move_back(candidate.hand, part.tl(), scale);
    return candidate;
}

/// Of several that lie within one another only the best.
std::vector<Hand> HandSearch::best_of(std::vector<Candidate> candidates) const
{
    std::ranges::stable_sort(candidates, std::ranges::greater{}, &Candidate::worth);
    std::vector<Hand> hands;
    for (const Candidate& candidate : candidates) {
        const auto same = [&](const Hand& other) {
            const double apart = std::hypot(other.palm.x - candidate.hand.palm.x, other.palm.y - candidate.hand.palm.y);
            return apart < reach * other.radius;
        };
        if (candidate.worth >= min_worth && hands.size() < static_cast<std::size_t>(max_hands)
            && std::ranges::none_of(hands, same))
            hands.push_back(candidate.hand);
    }
    return hands;
}

}  // namespace gesture

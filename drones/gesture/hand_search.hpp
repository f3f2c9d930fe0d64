// Finds hands in colour images by the colour of the person's skin, and reads them. Plain OpenCV.
#pragma once

#include "gesture_finder.hpp"
#include "silhouette.hpp"
#include "skin.hpp"

#include <opencv2/objdetect.hpp>

#include <optional>
#include <string>
#include <vector>

namespace gesture {

/// The skin is that of a face in the image, or of a given region; without both, all colours in SkinRange may be skin.
/// Faces and necks are excluded. Each place where a disc of the size of a palm fits into the remaining area is
/// examined: enlarged, with the colour of that place, and without pixels further away than a hand reaches, so that an
/// arm ends at the wrist. The best place that looks like a hand is the hand.
class HandSearch {
public:
    int max_hands = 1;
    double tolerance = 3;  ///< how far a colour may be from that of the skin, standard deviations
    cv::Rect region;       ///< of skin, px; empty: detect a face
    SkinRange range;       ///< without a face and a region

    /// The cascade that finds faces; empty: no face detection. @throws std::runtime_error  with the
    /// reason
    void load_faces(const std::string& cascade_path);
    /// @param image  8 bit, BGR; not changed
    /// @return  the best first
    [[nodiscard]] std::vector<Hand> find(const cv::Mat& image);

private:
    /// A place where a palm may be.
    struct Place {
        cv::Point middle;
        double radius;  ///< px
    };
    /// A candidate and its score.
    struct Candidate {
        Hand hand;
        SkinColour skin;
        double worth;
    };

    [[nodiscard]] std::vector<cv::Rect> faces_in(const cv::Mat& image);
    [[nodiscard]] std::optional<SkinColour> known_skin(const cv::Mat& image, const std::vector<cv::Rect>& faces) const;
    [[nodiscard]] cv::Mat skin_in(const cv::Mat& image, const std::optional<SkinColour>& known, double deviations,
                                  const std::vector<cv::Rect>& faces) const;
    [[nodiscard]] static std::vector<Place> places_in(const cv::Mat& skin, double smallest, double largest);
    [[nodiscard]] static std::optional<Candidate> examine(const cv::Mat& image, const cv::Mat& skin,
                                                          const Place& place);
    [[nodiscard]] std::vector<Hand> best_of(std::vector<Candidate> candidates) const;

    cv::CascadeClassifier cascade_;
};

}  // namespace gesture

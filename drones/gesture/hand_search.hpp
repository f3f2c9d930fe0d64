// Finds hands in colour pictures by the colour of somebody's skin, and reads them. Plain OpenCV.
#pragma once

#include "gesture_finder.hpp"
#include "landmarks.hpp"
#include "silhouette.hpp"
#include "skin.hpp"

#include <opencv2/objdetect.hpp>

#include <string>
#include <vector>

namespace gesture {

/// The skin is that of a face in the picture, or of a region that somebody points at; without both, everything of the
/// colours of SkinRange may be skin. Faces and necks are left out. Each place where a disc of the size of a palm fits
/// into what is left is looked at closely: enlarged, with the colour of that very place, and without what is further
/// away than a hand reaches, so that an arm ends at the wrist. The best one that looks like a hand is one.
class HandSearch {
public:
    int max_hands = 1;
    double tolerance = 3;  ///< how far a colour may be from that of the skin, standard deviations
    cv::Rect region;       ///< of skin, px; empty: look for a face
    SkinRange range;       ///< without a face and a region
    /// Says which of the best places is a hand, and reads it; none: the outline tells.
    std::optional<HandLandmarks> landmarks;

    /// The cascade that finds faces; without one no face is looked for. @throws std::runtime_error  says what is wrong
    void load_faces(const std::string& cascade_path);
    /// @param picture  8 bit, BGR; not changed
    /// @return  the best first
    [[nodiscard]] std::vector<Hand> find(const cv::Mat& picture);

private:
    /// A place where a palm may be.
    struct Place {
        cv::Point middle;
        double radius;  ///< px
    };
    /// What looks like a hand, and how much.
    struct Candidate {
        Hand hand;
        SkinColour skin;
        double worth;
    };

    [[nodiscard]] std::vector<cv::Rect> faces_in(const cv::Mat& picture);
    [[nodiscard]] std::optional<SkinColour> known_skin(const cv::Mat& picture,
                                                       const std::vector<cv::Rect>& faces) const;
    [[nodiscard]] cv::Mat skin_in(const cv::Mat& picture, const std::optional<SkinColour>& known, double deviations,
                                  const std::vector<cv::Rect>& faces) const;
    [[nodiscard]] static std::vector<Place> places_in(const cv::Mat& skin, double smallest, double largest);
    [[nodiscard]] static std::optional<Candidate> look_at(const cv::Mat& picture, const cv::Mat& skin,
                                                          const Place& place);
    [[nodiscard]] std::vector<Hand> best_of(const cv::Mat& picture, std::vector<Candidate> candidates);

    cv::CascadeClassifier cascade_;
};

}  // namespace gesture

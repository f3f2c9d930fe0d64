// Ground truth boxes from the NAME.gt.csv next to a clip.
#pragma once

#include <opencv2/core/types.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace media {

/// A box and its object.
struct TrueBox {
    int id;
    cv::Rect2d box;
};

/// The boxes by image, from 1. The first line is a heading, each other one `picture,id,x,y,w,h` in px.
inline std::map<int, std::vector<TrueBox>> ground_truth(const std::filesystem::path& path)
{
    std::map<int, std::vector<TrueBox>> boxes;
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
        std::ranges::replace(line, ',', ' ');
        std::istringstream fields(line);
        int image = 0;
        TrueBox one{};
        if (fields >> image >> one.id >> one.box.x >> one.box.y >> one.box.width >> one.box.height)
            boxes[image].push_back(one);
    }
    return boxes;
}

}  // namespace media

// Writes detections as comma-separated values.
#include "csv.hpp"

#include <hive/recording/dataset.hpp>

namespace hive::recording {
namespace {

using csv::field;
using csv::joined;

template <class Value>
std::string field(const std::optional<Value>& value)
{
    return value ? Json(*value).dump() : "";
}

std::string size_field(std::int64_t size) { return size > 0 ? std::to_string(size) : ""; }

}  // namespace

std::string csv_heading()
{
    return "image,width,height,source,epoch,seq,time_us,media_time_us,sender,output,category,id,score,x,y,w,h,"
           "confirmed,missing\n";
}

std::string csv_rows(const DetectedImage& image)
{
    const auto of_image =
        joined({field(image.name), size_field(image.width), size_field(image.height), field(image.source),
                std::to_string(image.epoch), std::to_string(image.sequence), std::to_string(image.captured_us),
                field(image.media_time_us), field(image.sender), field(image.output)});
    std::string rows;
    for (const Detection& one : image.detections)
        rows += of_image + ","
                + joined({field(one.category), field(one.id), field(one.score), Json(one.x).dump(), Json(one.y).dump(),
                          Json(one.w).dump(), Json(one.h).dump(), field(one.confirmed), field(one.missing)})
                + "\n";
    return rows;
}

}  // namespace hive::recording

// A cv::MatAllocator over loans.
#include <hive/error.hpp>
#include <hive/vision/loans.hpp>

#include <opencv2/imgproc.hpp>

#include <memory>

namespace hive::vision {

cv::Mat LoanAllocator::image()
{
    cv::Mat image;
    image.allocator = this;
    return image;
}

cv::Mat LoanAllocator::colour_copy(const cv::Mat& original)
{
    cv::Mat copy = image();
    if (original.channels() == 1)
        cv::cvtColor(original, copy, cv::COLOR_GRAY2BGR);
    else
        original.copyTo(copy);
    return copy;
}

void LoanAllocator::close()
{
    const std::lock_guard lock(mutex_);
    lend_ = nullptr;
}

const Loan* LoanAllocator::loan_of(const cv::Mat& image)
{
    const bool lent = image.u && dynamic_cast<const LoanAllocator*>(image.u->currAllocator);
    return lent ? static_cast<const Loan*>(image.u->userdata) : nullptr;
}

/// If this throws, OpenCV uses ordinary memory.
Loan LoanAllocator::lend(std::size_t bytes) const
{
    const std::lock_guard lock(mutex_);
    if (!lend_)
        throw Error(Errc::stopped, "lending has stopped");
    return lend_(bytes);
}

cv::UMatData* LoanAllocator::allocate(int dims, const int* sizes, int type, void* data, std::size_t* step,
                                      cv::AccessFlag flags, cv::UMatUsageFlags usage) const
{
    if (data)  // the pixels already exist
        return cv::Mat::getStdAllocator()->allocate(dims, sizes, type, data, step, flags, usage);
    std::size_t bytes = CV_ELEM_SIZE(type);
    for (int i = dims - 1; i >= 0; --i) {
        if (step)
            step[i] = bytes;
        bytes *= static_cast<std::size_t>(sizes[i]);
    }
    auto loan = std::make_unique<Loan>(lend(bytes));
    auto pixels = std::make_unique<cv::UMatData>(this);
    pixels->data = pixels->origdata = loan->data();
    pixels->size = bytes;
    pixels->userdata = loan.release();
    return pixels.release();
}

bool LoanAllocator::allocate(cv::UMatData* data, cv::AccessFlag, cv::UMatUsageFlags) const { return data != nullptr; }

void LoanAllocator::deallocate(cv::UMatData* data) const
{
    if (!data)
        return;
    delete static_cast<Loan*>(data->userdata);
    delete data;
}

}  // namespace hive::vision

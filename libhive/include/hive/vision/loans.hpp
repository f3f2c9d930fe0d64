// Lets OpenCV create images directly in the buffer that is emitted.
#pragma once

#include <hive/body.hpp>

#include <opencv2/core/mat.hpp>

#include <functional>
#include <mutex>

namespace hive::vision {

/// Allocates the pixels of cv::Mat from an output's loans: `LoanAllocator loans([=](std::size_t bytes) { return
/// output.loan(bytes); })`. Any function that fills such an image (cv::resize, VideoCapture::read, copyTo) fills the
/// loan, and encode_raw() copies nothing. The allocator must outlive its images, but need not outlive the bodies made
/// of them. Images can be created on any thread; one thread at a time uses each.
class LoanAllocator final : public cv::MatAllocator {
public:
    using Lend = std::function<Loan(std::size_t bytes)>;
    explicit LoanAllocator(Lend lend) : lend_(std::move(lend)) {}

    /// An empty image whose pixels will be in a loan.
    [[nodiscard]] cv::Mat image();
    /// A colour copy (BGR) of an image of 1 or 3 channels, in a loan.
    [[nodiscard]] cv::Mat colour_copy(const cv::Mat& original);
    /// Allocates ordinary memory from now on, so that the lender can be destroyed.
    void close();
    /// The loan that holds the pixels, or nullptr.
    static const Loan* loan_of(const cv::Mat& image);

    cv::UMatData* allocate(int dims, const int* sizes, int type, void* data, std::size_t* step, cv::AccessFlag flags,
                           cv::UMatUsageFlags usage) const override;
    bool allocate(cv::UMatData* data, cv::AccessFlag flags, cv::UMatUsageFlags usage) const override;
    void deallocate(cv::UMatData* data) const override;

private:
    [[nodiscard]] Loan lend(std::size_t bytes) const;

    mutable std::mutex mutex_;
    Lend lend_;
};

}  // namespace hive::vision

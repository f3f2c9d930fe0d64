// Pictures in lent memory: what OpenCV makes lies from the beginning in the buffer that is emitted.
#pragma once

#include <hive/body.hpp>

#include <opencv2/core/mat.hpp>

#include <functional>
#include <mutex>

namespace hive::vision {

/// Gives cv::Mat its pixels from an output's loans: `LoanAllocator loans([=](std::size_t bytes) { return
/// output.loan(bytes); })`. Whatever fills such a picture (cv::resize, VideoCapture::read, copyTo) fills the loan, and
/// encode_raw() copies nothing. Outlives its pictures, but not the bodies made of them. Pictures may be made on any
/// thread, each used by one at a time.
class LoanAllocator final : public cv::MatAllocator {
public:
    using Lend = std::function<Loan(std::size_t bytes)>;
    explicit LoanAllocator(Lend lend) : lend_(std::move(lend)) {}

    /// An empty picture; its pixels will lie in a loan.
    [[nodiscard]] cv::Mat picture();
    /// A copy in colour (BGR) of a picture of 1 or 3 channels, in a loan: what is drawn on it is drawn in the memory
    /// that is emitted.
    [[nodiscard]] cv::Mat colour_copy(const cv::Mat& original);
    /// From now on pictures lie in ordinary memory, so that the lender may go.
    void close();
    /// The loan that holds the pixels, or nullptr.
    static const Loan* loan_of(const cv::Mat& picture);

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

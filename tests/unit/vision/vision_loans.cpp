// Images in loans: drawn where they are emitted from, copied nowhere.
#include "media.hpp"
#include "scene.hpp"
#include "source.hpp"

#include <doctest/doctest.h>
#include <hive/vision/image.hpp>
#include <hive/vision/loans.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include <memory>

namespace vision = hive::vision;

namespace {

/// Lends ordinary memory and remembers it.
class Lender {
public:
    vision::LoanAllocator allocator{[this](std::size_t bytes) { return lend(bytes); }};
    std::weak_ptr<const void> last;
    int loans = 0;

private:
    hive::Loan lend(std::size_t bytes)
    {
        auto memory = std::make_shared<std::vector<std::byte>>(bytes);
        last = memory;
        ++loans;
        const std::span span(*memory);
        return {span, std::move(memory)};
    }
};

}  // namespace

TEST_CASE("loans: an image drawn in a loan is the body, without a copy")
{
    Lender lender;
    cv::Mat image = lender.allocator.image();
    cv::resize(media::sample({64, 48}, CV_8UC3), image, {32, 24});
    REQUIRE(lender.loans == 1);
    const auto* pixels = image.data;
    const hive::Body body = vision::encode_raw(image);
    CHECK(body.data() == pixels);
    CHECK(body.size() == 32 * 24 * 3);
}

TEST_CASE("loans: the body keeps the loan when the image and its allocator are gone")
{
    hive::Body body;
    std::weak_ptr<const void> memory;
    {
        Lender lender;
        cv::Mat image = lender.allocator.image();
        media::sample({16, 16}, CV_8UC1).copyTo(image);
        body = vision::encode_raw(image);
        memory = lender.last;
    }
    CHECK_FALSE(memory.expired());
    CHECK(body.data()[5] == media::sample({16, 16}, CV_8UC1).data[5]);
    body = {};
    CHECK(memory.expired());
}

TEST_CASE("loans: an image that is not emitted returns its loan")
{
    Lender lender;
    lender.allocator.image().create(10, 10, CV_8UC3);
    CHECK(lender.loans == 1);
    CHECK(lender.last.expired());
}

TEST_CASE("loans: a part of a lent image is copied, whether its rows lie apart or not")
{
    Lender lender;
    cv::Mat image = lender.allocator.image();
    media::sample({20, 20}, CV_8UC3).copyTo(image);
    for (const cv::Rect where : {cv::Rect(2, 2, 10, 10), cv::Rect(0, 5, 20, 15)}) {
        const cv::Mat part = image(where);
        const hive::Body body = vision::encode_raw(part);
        CHECK(body.data() != part.data);
        CHECK(media::same(vision::decode(body, "image/raw", {}, vision::raw_header(part)), part));
    }
}

TEST_CASE("loans: after the lender has closed, or when it throws, images lie in ordinary memory")
{
    Lender lender;
    lender.allocator.close();
    cv::Mat image = lender.allocator.image();
    image.create(10, 10, CV_8UC3);
    CHECK(lender.loans == 0);
    CHECK(vision::LoanAllocator::loan_of(image) == nullptr);
    CHECK(vision::encode_raw(image).size() == 300);
    vision::LoanAllocator empty([](std::size_t) -> hive::Loan { throw std::runtime_error("nothing left"); });
    cv::Mat other = empty.image();
    other.create(10, 10, CV_8UC3);
    CHECK(other.total() == 100);
}

TEST_CASE("loans: the scene is drawn in one loan for each image, and is the same as in ordinary memory")
{
    Lender lender;
    const camera::Scene scene({.size = {320, 240}});
    const auto lent = scene.frame(3, &lender.allocator), own = scene.frame(3);
    CHECK(lender.loans == 1);
    CHECK(vision::LoanAllocator::loan_of(lent.image));
    CHECK(media::same(lent.image, own.image));
}

TEST_CASE("loans: an image file is decoded into one loan")
{
    Lender lender;
    const media::Folder folder;
    const cv::Mat image = media::sample({64, 48}, CV_8UC3);
    media::write(folder.path() / "a.png", media::encoded(".png", image));
    camera::SourceSettings settings;
    settings.text = (folder.path() / "a.png").string();
    const auto frame = camera::open_source(settings, &lender.allocator)->next();
    REQUIRE(frame);
    CHECK(media::same(frame->image, image));
    CHECK(lender.loans == 1);
    CHECK(vision::LoanAllocator::loan_of(frame->image));
}

TEST_CASE("loans: a video is read into a loan of its own for each image")
{
    Lender lender;
    const media::Folder folder;
    camera::SourceSettings settings;
    settings.text = (folder.path() / "v.avi").string();
    cv::VideoWriter writer(settings.text, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 12, {64, 48});
    for (int i = 0; i < 3; ++i)
        writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(50 * i)));
    writer.release();
    const auto source = camera::open_source(settings, &lender.allocator);
    const auto first = source->next(), second = source->next();
    REQUIRE((first && second));
    CHECK(lender.loans == 2);
    CHECK(vision::LoanAllocator::loan_of(first->image));
    CHECK(vision::LoanAllocator::loan_of(second->image));
    CHECK(cv::mean(first->image)[0] < cv::mean(second->image)[0]);
}

TEST_CASE("plain form: pixels as they are, but an image of more than a body may hold is a JPEG")
{
    const cv::Mat image = media::sample({64, 48}, CV_8UC3);
    const auto plain = vision::plain_form(image.size(), 3);
    CHECK(plain.type == "image/raw");
    CHECK(plain.header == vision::raw_header(image));
    CHECK(plain.body(image).data() == image.data);
    CHECK(vision::plain_form({8192, 8192}, 1).type == "image/raw");
    const auto large = vision::plain_form({8192, 8192}, 3);
    CHECK(large.type == "image/jpeg");
    CHECK(large.header == hive::Json{{"width", 8192}, {"height", 8192}});
    CHECK(vision::decode(large.body(image), "image/jpeg").size() == image.size());
}

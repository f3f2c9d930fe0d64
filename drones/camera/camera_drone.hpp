// Ties the sources to the drone's parameters and output.
#pragma once

#include "capture.hpp"
#include "source.hpp"

#include <hive/drone.hpp>
#include <hive/vision/image.hpp>
#include <hive/vision/loans.hpp>

#include <memory>
#include <set>
#include <string>
#include <vector>

namespace camera {

/// On the user thread.
class CameraDrone {
public:
    explicit CameraDrone(hive::Drone& drone);
    CameraDrone(const CameraDrone&) = delete;
    CameraDrone& operator=(const CameraDrone&) = delete;
    /// A capture that is stuck in a read may outlive the drone, and must not use the drone's loans then.
    ~CameraDrone() { memory_->close(); }
    void run() { drone_.run(); }

private:
    /// The source by the parameters; a difference to the open one means reopening.
    struct Wanted {
        SourceSettings source;
        double fps = 0;
        std::string pace = "live";
        bool operator==(const Wanted&) const = default;
    };

    void declare();
    [[nodiscard]] Wanted wanted() const;
    void apply();
    void open(const Wanted& wanted);
    std::chrono::microseconds step();
    std::chrono::microseconds step_live();
    std::chrono::microseconds step_on_demand();
    std::chrono::microseconds send(const Frame& frame, bool lossless);
    std::chrono::microseconds lack(std::chrono::system_clock::time_point captured, bool lossless, hive::Errc code,
                                   const std::string& text);
    void emit(const Frame& frame, bool lossless);
    [[nodiscard]] hive::Json about(const Frame& frame) const;
    [[nodiscard]] hive::Body pixels(const Frame& frame, const hive::vision::PlainForm& form, cv::Size size);
    bool is_news(const std::string& text);
    void report(const std::vector<std::string>& sentences);
    void end(const std::string& cut_short);
    void say(const std::string& condition, hive::Reason why = hive::Reason::none);

    hive::Drone& drone_;
    hive::Output image_;
    std::shared_ptr<hive::vision::LoanAllocator> memory_;  ///< of the images, also those that the capture reads
    std::string source_ = "scene", pace_ = "live", credentials_, transport_ = "tcp", certificate_, format_;
    int width_ = 0, height_ = 0, faces_ = 1, walkers_ = 0, seed_ = 1;
    double fps_ = 0, noise_ = 3;
    bool loop_ = true, hand_ = false, basic_over_http_ = false;

    std::optional<Wanted> opened_;
    std::unique_ptr<Capture> capture_;   ///< pace=live
    std::unique_ptr<Source> on_demand_;  ///< pace=demand; gone at its end
    bool ended_ = false;
    std::set<std::string> reported_;  ///< about this source
    std::string condition_;
};

}  // namespace camera

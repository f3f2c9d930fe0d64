// The main function of test programs that use OpenCV as the drones do.
#include <possible.hpp>

#include <opencv2/core/utility.hpp>
#include <opencv2/core/utils/logger.hpp>

int main(int argc, char** argv)
{
    cv::setNumThreads(1);  // as in the drones
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    return hive::test::run_cases(argc, argv);
}

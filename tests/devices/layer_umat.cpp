// An OpenCV program that knows nothing of Partita: a blur through the transparent API against the
// same blur on the host.
#include <cstdio>

#include <opencv2/core/ocl.hpp>
#include <opencv2/imgproc.hpp>

int main() {
  cv::ocl::setUseOpenCL(true);
  if (!cv::ocl::useOpenCL()) return 2;
  cv::Mat image(480, 640, CV_8UC1), expected, result;
  cv::randu(image, 0, 255);
  cv::UMat in, out;
  image.copyTo(in);
  cv::GaussianBlur(in, out, cv::Size(5, 5), 1.5);
  out.copyTo(result);
  cv::GaussianBlur(image, expected, cv::Size(5, 5), 1.5);
  const double difference = cv::norm(result, expected, cv::NORM_INF);
  std::printf("blurred on %s, largest difference %.0f\n",
              cv::ocl::Device::getDefault().name().c_str(), difference);
  return difference <= 1 ? 0 : 1;
}

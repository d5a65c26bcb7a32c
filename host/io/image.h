// Pictures on disk. Reading is strict: what is truncated or damaged is an Error, never half a
// picture. Writing is atomic.
#ifndef PARTITA_HOST_IO_IMAGE_H
#define PARTITA_HOST_IO_IMAGE_H

#include <string>

#include "host/tasks/sensing/frame.h"

namespace partita::io {

struct GrayRead {
  sensing::GrayImage image;
  std::string converted;  ///< what the file held where it was not 8-bit gray ("colour", "16-bit")
};

/// Reads a PNG, JPEG or PGM/PPM file as 8-bit gray. Colour is converted by the weights of
/// ITU-R BT.601 in integers (the same on every machine), 16 bits lose their lower eight.
/// Throws Error that names the file for anything missing, damaged, truncated or of another format.
GrayRead read_gray(const std::string& path);

struct LevelsRead {
  sensing::Image<std::uint16_t> levels;
  int bits = 8;  ///< of the file: 8 or 16
};

/// Reads a picture whose levels are no brightness but numbers, and so are not to be converted: one
/// channel, or, as palettes decode, three that are equal in every pixel. Throws Error as read_gray
/// does, and for a picture with colours.
LevelsRead read_levels(const std::string& path);

/// As read_gray, in colour; gray becomes three equal channels.
sensing::ColourImage read_colour(const std::string& path);

/// Throws what reading would throw for a file that is missing, truncated or no picture, without the
/// time that decoding takes.
void check_picture(const std::string& path);

/// Writes a PNG.
void write_colour(const std::string& path, const sensing::ColourImage& image);
void write_gray(const std::string& path, const sensing::GrayImage& image);

/// Disparities as KITTI writes them: 16-bit PNG, value = disparity * 256 rounded to nearest, 0 =
/// none. What is not positive or not finite is written as none; at most 255.996 can be held.
void write_disparity(const std::string& path, const sensing::FloatImage& disparity);
sensing::FloatImage read_disparity(const std::string& path);

/// Writes a disparity map in the format that the name's ending asks for: .png as above, .pfm as in
/// pfm.h. is_disparity_name() says whether it is one of the two, in letters of either case.
void write_disparity_as(const std::string& path, const sensing::FloatImage& disparity);
bool is_disparity_name(const std::string& path);

/// The same for people: a colour PNG with dark blue for 0 to dark red for `max_disparity`, black
/// where there is none, and a labelled colour bar below.
void write_disparity_picture(const std::string& path, const sensing::FloatImage& disparity,
                             double max_disparity);

}  // namespace partita::io

#endif  // PARTITA_HOST_IO_IMAGE_H

// Whether an image file is whole. OpenCV's decoders return partly decoded pictures for truncated
// files and say so, if at all, on stderr; so the structure is checked before they see it.
#ifndef PARTITA_HOST_IO_IMAGE_CHECK_H
#define PARTITA_HOST_IO_IMAGE_CHECK_H

#include <string>
#include <string_view>

namespace partita::io {

/// What is wrong with the bytes of a PNG (every chunk present with its checksum, up to IEND), a
/// JPEG (every segment present, a frame, and the end marker) or a binary PGM/PPM (as many samples
/// as the header says): "truncated", "damaged (...)", "not a PNG, JPEG or PGM picture". Empty: it
/// is whole. Sizes of at most 16384 x 16384 are accepted.
std::string image_defect(std::string_view bytes);

}  // namespace partita::io

#endif  // PARTITA_HOST_IO_IMAGE_CHECK_H

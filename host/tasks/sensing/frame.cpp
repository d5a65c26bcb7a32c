#include "host/tasks/sensing/frame.h"

namespace partita::sensing {

const char* to_string(ObjectClass c) {
  switch (c) {
    case ObjectClass::car:
      return "Car";
    case ObjectClass::pedestrian:
      return "Pedestrian";
    case ObjectClass::cyclist:
      return "Cyclist";
  }
  return "";
}

}  // namespace partita::sensing

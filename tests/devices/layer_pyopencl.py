# A pyopencl script that knows nothing of Partita: squares numbers on every device there is and
# prints what each said. usage: layer_pyopencl.py [device name that must be there]
import sys

import numpy
import pyopencl

SOURCE = "__kernel void square(__global float *a) { int i = get_global_id(0); a[i] *= a[i]; }"


def run(device):
    context = pyopencl.Context([device])
    queue = pyopencl.CommandQueue(
        context, properties=pyopencl.command_queue_properties.PROFILING_ENABLE)
    try:
        program = pyopencl.Program(context, SOURCE).build(cache_dir=False)
    except pyopencl.Error as error:
        return "refused: " + str(error).splitlines()[0]
    numbers = numpy.arange(1024, dtype=numpy.float32)
    buffer = pyopencl.Buffer(
        context, pyopencl.mem_flags.READ_WRITE | pyopencl.mem_flags.COPY_HOST_PTR, hostbuf=numbers)
    event = program.square(queue, numbers.shape, None, buffer)
    result = numpy.empty_like(numbers)
    pyopencl.enqueue_copy(queue, result, buffer)
    assert (result == numbers * numbers).all()
    assert event.profile.queued <= event.profile.submit <= event.profile.start < event.profile.end
    return "computed in %d ns" % (event.profile.end - event.profile.start)


def main():
    for platform in pyopencl.get_platforms():
        for device in platform.get_devices():
            print("%s: %s" % (device.name, run(device)))


if __name__ == "__main__":
    sys.exit(main())

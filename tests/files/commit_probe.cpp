// Writes files of a text to a folder, all together. It is a separate process because it gets
// killed. commit_probe FOLDER TEXT [durable]
#include <cstdio>
#include <filesystem>

#include "libatlas/files/atomic_file.h"

int main(int count, char** argument) {
  const std::filesystem::path folder = argument[1];
  atlas::AtomicFiles files;
  atlas::Status status;
  for (const char* name : {"world_0.png", "world_1.png", "world.mtl", "world.obj"})
    if (status.ok()) status = files.write(folder / name, argument[2] + std::string(name));
  if (status.ok()) status = files.commit(count > 3);
  if (!status.ok()) std::puts(status.message().c_str());
  return status.ok() ? 0 : 1;
}

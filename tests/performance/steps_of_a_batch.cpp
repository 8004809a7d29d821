// Steps of a batch in lanes, for the count of their instructions: SCENE, members, steps.
#include <cstdlib>
#include <iostream>

#include "der/batch/batch.hpp"

int main(int count, char** words) {
  if (count != 4) {
    std::cerr << "usage: der_batch_steps SCENE MEMBERS STEPS\n";
    return 2;
  }
  der::Batch batch(der::Scenario::load(words[1]), std::strtoul(words[2], nullptr, 10), {}, 1, {});
  batch.step(std::strtol(words[3], nullptr, 10), {});
  return 0;
}

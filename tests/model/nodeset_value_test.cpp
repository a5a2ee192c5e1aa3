#include "nodeset_fixture.hpp"

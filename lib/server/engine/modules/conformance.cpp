#include <busbar/server/modules.hpp>

#include "server/engine/conformance_facts.hpp"
#include "server/engine/core.hpp"

namespace busbar::server {

namespace detail {

namespace {

Conformance assess_core(const Core& core)
{
    return assess(conformance_facts(core));
}

void add_conformance(Core& core)
{
    core.assess_all = assess_core;
}

} // namespace

} // namespace detail

constinit const Module modules::conformance{"conformance", detail::add_conformance};

} // namespace busbar::server

#include <busbar/tool/program.hpp>

int main(int argc, char** argv)
{
    return busbar::tool::run_program(argc, argv);
}

#include <busbar/product/program.hpp>

int main(int argc, char** argv)
{
    return busbar::product::run_program(argc, argv);
}

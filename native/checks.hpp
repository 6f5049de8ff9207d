// Checks of what the kernels take on trust: elements, blocks of a matrix, fronts of a factorisation.
#pragma once
#include "kernels.hpp"

// Room that a factorisation is given, in numbers.
struct FrontRoom {
    int64_t rows, runs, entries;  // lists of the fronts
    int64_t data, lower;
    int64_t first, second;        // stacks; -1 where they are made to measure
    int64_t spare;
};

// Corners of elements are nodes.
void demand_corners(const Elements& all, int64_t nodes);

void demand_corners(const Quadratics& all, int64_t nodes);

// Columns of the nodes are no longer than the matrix; returns the longest.
int64_t demand_strides(const int64_t* strides, int64_t nodes, int64_t size);

// Panels lie within the factors, rows and columns within the matrix; returns the height of the highest front.
int64_t demand_panels(const Fronts& fronts, int64_t rows, int64_t lower);

// The fronts are a tree in postorder, of which no part lies outside its room.
void demand_fronts(const Fronts& fronts, const FrontRoom& room);

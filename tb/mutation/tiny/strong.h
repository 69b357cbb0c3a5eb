#pragma once
/// Whether `year` is a leap year of the Gregorian calendar.
bool leap(int year);
/// Sum of the even numbers below n.
int even_sum(int n);
